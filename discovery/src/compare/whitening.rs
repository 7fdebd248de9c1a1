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

use std::array::from_fn;

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
}

impl Past {
    fn new(column: &[f64], outputs: usize) -> Self {
        let mut sums = vec![0.0; column.len() + outputs];
        for (k, value) in column.iter().enumerate() {
            sums[k + outputs] = sums[k] + value;
        }
        Self { sums }
    }

    /// The sums over a window before a group, one an output; what lies before `first` counts as 0.
    #[inline]
    fn sums<const M: usize>(&self, window: usize, first: usize, group: usize) -> [f64; M] {
        let (near, far) = WINDOWS[window];
        let to = &self.sums[(group + 1).saturating_sub(near).max(first) * M..][..M];
        let from = &self.sums[group.saturating_sub(far).max(first) * M..][..M];
        from_fn(|j| to[j] - from[j])
    }
}

impl Whitening {
    /// The filter that makes this residual white.
    pub(super) fn fit(residual: &[f64], layout: &Layout) -> Self {
        match layout.outputs {
            1 => Self::fit_to::<1>(residual, layout),
            2 => Self::fit_to::<2>(residual, layout),
            3 => Self::fit_to::<3>(residual, layout),
            4 => Self::fit_to::<4>(residual, layout),
            _ => Self::fit_to::<5>(residual, layout),
        }
    }

    fn fit_to<const M: usize>(residual: &[f64], layout: &Layout) -> Self {
        let width = M * WINDOWS.len();
        let mut information = DMatrix::<f64>::zeros(width, width);
        let mut cross = DMatrix::<f64>::zeros(width, M);
        let mut means = DVector::<f64>::zeros(width);
        let past = Past::new(residual, M);
        for (first, group) in predicted(layout) {
            for (window, (near, far)) in WINDOWS.into_iter().enumerate() {
                for (j, sum) in past.sums::<M>(window, first, group).into_iter().enumerate() {
                    means[window * M + j] = sum / (far + 1 - near) as f64;
                }
            }
            information.syger(1.0, &means, &means, 1.0);
            for j in 0..M {
                cross.column_mut(j).axpy(residual[group * M + j], &means, 1.0);
            }
        }
        let ridge = RIDGE * information.trace() / width as f64 + f64::MIN_POSITIVE;
        for k in 0..width {
            information[(k, k)] += ridge;
        }
        information.fill_upper_triangle_with_lower_triangle();
        let predict = information
            .cholesky()
            .map_or_else(|| DMatrix::zeros(M, width), |it| it.solve(&cross).transpose());
        let mut whitening = Self { predict, scale: DMatrix::identity(M, M) };
        let innovations = whitening.apply_to::<M>(residual, layout);
        let mut covariance = DMatrix::<f64>::identity(M, M) * f64::MIN_POSITIVE;
        let count = predicted(layout).count().max(1) as f64;
        for v in innovations.chunks(M) {
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
        match layout.outputs {
            1 => self.apply_to::<1>(column, layout),
            2 => self.apply_to::<2>(column, layout),
            3 => self.apply_to::<3>(column, layout),
            4 => self.apply_to::<4>(column, layout),
            _ => self.apply_to::<5>(column, layout),
        }
    }

    fn apply_to<const M: usize>(&self, column: &[f64], layout: &Layout) -> Vec<f64> {
        let past = Past::new(column, M);
        let mut out = vec![0.0; column.len()];
        // What a running sum over each window predicts: by window, output, predicted output.
        let predict: [[[f64; M]; M]; WINDOWS.len()] = from_fn(|window| {
            let (near, far) = WINDOWS[window];
            let width = (far + 1 - near) as f64;
            from_fn(|l| from_fn(|j| self.predict[(j, window * M + l)] / width))
        });
        for (first, group) in predicted(layout) {
            let mut v: [f64; M] = from_fn(|j| column[group * M + j]);
            for (window, predict) in predict.iter().enumerate() {
                let sums = past.sums::<M>(window, first, group);
                for (sum, predict) in sums.iter().zip(predict) {
                    for (v, predict) in v.iter_mut().zip(predict) {
                        *v -= predict * sum;
                    }
                }
            }
            for j in 0..M {
                out[group * M + j] = (0..=j).map(|l| self.scale[(j, l)] * v[l]).sum();
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
