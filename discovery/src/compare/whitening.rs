//! A coloured residual made white by a vector autoregression
//!
//! r_k = sum_w A_w m_w,k + v_k,  m_w,k = mean of r over the window w of the past,  cov(v) = S,
//!
//! fitted by least squares (Lütkepohl, New Introduction to Multiple Time Series Analysis, 2005,
//! chapter 3). A random load torque moves all outputs together and slowly. Filtering residual and
//! columns alike by v is generalised least squares: without it such a load hides small effects,
//! and correlated errors feign others.
//!
//! The windows widen into the past (the heterogeneous autoregression of Corsi, 2009): what is slow
//! below the noise of the sensors is predicted by a mean over a long time, which single lags could
//! only tell with hundreds of coefficients.

use nalgebra::{DMatrix, DVector};

use super::layout::Layout;

/// Windows of the past, in groups: first and last.
const WINDOWS: [(usize, usize); 12] = [
    (1, 1),
    (2, 2),
    (3, 3),
    (4, 4),
    (5, 6),
    (7, 8),
    (9, 12),
    (13, 20),
    (21, 40),
    (41, 80),
    (81, 160),
    (161, 320),
];
/// Groups at the beginning of a recording whose past is too little known.
pub(super) const FIRST: usize = 20;
/// Added to the diagonal of the information, relative to its mean.
const RIDGE: f64 = 1e-6;

/// The filter from a residual to its innovations.
pub(super) struct Whitening {
    /// What the past predicts: a row an output, a column the mean of an output over a window.
    predict: DMatrix<f64>,
    /// Inverse of the Cholesky factor of S.
    scale: DMatrix<f64>,
}

/// Running sums of a column, output by output, from which means over windows are read off.
struct Past {
    sums: Vec<f64>,
    outputs: usize,
}

impl Past {
    fn new(column: &[f64], outputs: usize) -> Self {
        let mut sums = vec![0.0; column.len() + outputs];
        for (k, value) in column.iter().enumerate() {
            sums[k + outputs] = sums[k] + value;
        }
        Self { sums, outputs }
    }

    /// The means of each window, all outputs of a window together; what lies before `first`
    /// counts as 0.
    fn means(&self, first: usize, group: usize) -> impl Iterator<Item = f64> + '_ {
        let m = self.outputs;
        WINDOWS.into_iter().flat_map(move |(near, far)| {
            let width = (far + 1 - near) as f64;
            let to = (group + 1).saturating_sub(near).max(first) * m;
            let from = group.saturating_sub(far).max(first) * m;
            (0..m).map(move |j| (self.sums[to + j] - self.sums[from + j]) / width)
        })
    }
}

impl Whitening {
    /// The filter that makes this residual white.
    pub(super) fn fit(residual: &[f64], layout: &Layout) -> Self {
        let m = layout.outputs;
        let width = m * WINDOWS.len();
        let mut information = DMatrix::<f64>::zeros(width, width);
        let mut cross = DMatrix::<f64>::zeros(width, m);
        let mut means = DVector::<f64>::zeros(width);
        let past = Past::new(residual, m);
        for (first, group) in predicted(layout) {
            means.iter_mut().zip(past.means(first, group)).for_each(|(to, from)| *to = from);
            information.syger(1.0, &means, &means, 1.0);
            for j in 0..m {
                cross.column_mut(j).axpy(residual[group * m + j], &means, 1.0);
            }
        }
        let ridge = RIDGE * information.trace() / width as f64 + f64::MIN_POSITIVE;
        for k in 0..width {
            information[(k, k)] += ridge;
        }
        information.fill_upper_triangle_with_lower_triangle();
        let predict = information
            .cholesky()
            .map_or_else(|| DMatrix::zeros(m, width), |it| it.solve(&cross).transpose());
        let mut whitening = Self { predict, scale: DMatrix::identity(m, m) };
        let innovations = whitening.apply(residual, layout);
        let mut covariance = DMatrix::<f64>::identity(m, m) * f64::MIN_POSITIVE;
        let count = predicted(layout).count().max(1) as f64;
        for v in innovations.chunks(m) {
            let v = DVector::from_column_slice(v);
            covariance.ger(1.0 / count, &v, &v, 1.0);
        }
        if let Some(scale) = covariance.cholesky().and_then(|it| it.l().try_inverse()) {
            whitening.scale = scale;
        }
        whitening
    }

    /// The filtered column; 0 where its past is not known.
    pub(super) fn apply(&self, column: &[f64], layout: &Layout) -> Vec<f64> {
        let m = layout.outputs;
        let past = Past::new(column, m);
        let mut out = vec![0.0; column.len()];
        let mut v = vec![0.0; m];
        for (first, group) in predicted(layout) {
            v.copy_from_slice(&column[group * m..(group + 1) * m]);
            for (place, mean) in past.means(first, group).enumerate() {
                for (j, v) in v.iter_mut().enumerate() {
                    *v -= self.predict[(j, place)] * mean;
                }
            }
            for j in 0..m {
                out[group * m + j] = (0..=j).map(|l| self.scale[(j, l)] * v[l]).sum();
            }
        }
        out
    }

    /// The errors of predicting each group from those before, in units of the noise.
    pub(super) fn one_step(&self, residual: &[f64], layout: &Layout) -> Vec<f64> {
        let m = layout.outputs;
        let plain = Self { predict: self.predict.clone(), scale: DMatrix::identity(m, m) };
        plain.apply(residual, layout)
    }
}

/// Groups whose past is known, each with the first group of its recording.
fn predicted(layout: &Layout) -> impl Iterator<Item = (usize, usize)> + '_ {
    layout.starts.windows(2).flat_map(|span| {
        let groups = span[0] + FIRST..span[1].max(span[0] + FIRST);
        groups.map(|group| (span[0], group))
    })
}
