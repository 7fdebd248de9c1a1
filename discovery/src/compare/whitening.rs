//! A coloured residual made white by a vector autoregression
//!
//! r_k = A_1 r_(k-1) + ... + A_p r_(k-p) + v_k,  cov(v) = S,
//!
//! fitted by least squares (Lütkepohl, New Introduction to Multiple Time Series Analysis, 2005,
//! chapter 3). A random load torque moves all outputs together and slowly. Filtering residual and
//! columns alike by v is generalised least squares: without it such a load hides small effects,
//! and correlated errors feign others.

use nalgebra::{DMatrix, DVector};

use super::layout::Layout;

/// Past groups that predict.
pub(super) const ORDER: usize = 16;
/// Added to the diagonal of the information, relative to its mean.
const RIDGE: f64 = 1e-6;

/// The filter from a residual to its innovations.
pub(super) struct Whitening {
    /// What the past predicts: a row an output, a column a past value, the latest group first.
    predict: DMatrix<f64>,
    /// Inverse of the Cholesky factor of S.
    scale: DMatrix<f64>,
}

impl Whitening {
    /// The filter that makes this residual white.
    pub(super) fn fit(residual: &[f64], layout: &Layout) -> Self {
        let m = layout.outputs;
        let width = m * ORDER;
        let mut information = DMatrix::<f64>::zeros(width, width);
        let mut cross = DMatrix::<f64>::zeros(width, m);
        let mut past = DVector::<f64>::zeros(width);
        for group in predicted(layout) {
            for lag in 1..=ORDER {
                for j in 0..m {
                    past[(lag - 1) * m + j] = residual[(group - lag) * m + j];
                }
            }
            information.syger(1.0, &past, &past, 1.0);
            for j in 0..m {
                cross.column_mut(j).axpy(residual[group * m + j], &past, 1.0);
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
        let mut out = vec![0.0; column.len()];
        let mut v = vec![0.0; m];
        for group in predicted(layout) {
            for (j, v) in v.iter_mut().enumerate() {
                let mut sum = column[group * m + j];
                for lag in 1..=ORDER {
                    for l in 0..m {
                        sum -= self.predict[(j, (lag - 1) * m + l)] * column[(group - lag) * m + l];
                    }
                }
                *v = sum;
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

/// Groups whose past is known: all but the first of each recording.
pub(super) fn predicted(layout: &Layout) -> impl Iterator<Item = usize> + '_ {
    layout.starts.windows(2).flat_map(|span| span[0] + ORDER..span[1].max(span[0] + ORDER))
}
