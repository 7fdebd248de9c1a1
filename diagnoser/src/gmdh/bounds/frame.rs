//! Coordinates z in which a neuron's parameters are of order one: p = centre + T z.
//!
//! T whitens the regressors, (1/N) sum (T^T r)(T^T r)^T = sigma^2 I, and sigma is the largest error
//! of the least-squares estimate at the centre. Then |z| <= 1 + epsilon / sigma for every p that
//! errs by no more than epsilon anywhere: the mean square of (T^T r) . z / sigma is |z|^2.
//! The whitening is done twice, which keeps its digits (Cholesky QR 2: Y. Yamamoto et al., ETNA 44
//! (2015), 306-326).

use nalgebra::{DMatrix, DVector};

use super::equations::Equations;
use super::polytope::{HalfSpace, product};

/// Where and in which units a parameter set is described.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub(super) centre: DVector<f64>,
    pub(super) transform: DMatrix<f64>,
    /// Largest error of the least-squares estimate, in the unit of the filter's output.
    pub(super) sigma: f64,
}

impl Frame {
    /// The frame of these equations; `None` if their regressors are dependent.
    pub(super) fn of(equations: &Equations) -> Option<Self> {
        let d = equations.dimension;
        let mut transform = DMatrix::identity(d, d);
        for _ in 0..2 {
            let mut gram = DMatrix::<f64>::zeros(d, d);
            for r in equations.regressors() {
                let white = transform.tr_mul(&DVector::from_column_slice(r));
                gram.syger(1.0 / equations.len() as f64, &white, &white, 1.0);
            }
            gram.fill_upper_triangle_with_lower_triangle();
            let scale = gram.diagonal().map(|square| 1.0 / square.sqrt());
            let scale = DMatrix::from_diagonal(&scale);
            let factor = (&scale * gram * &scale).cholesky()?.unpack();
            let inverse = factor.transpose().solve_upper_triangular(&DMatrix::identity(d, d))?;
            transform = transform * scale * inverse;
        }
        let mut along = DVector::zeros(d);
        let mut counted = 0.0;
        for (r, middle) in equations.regressors().zip(equations.middles()) {
            if middle.is_finite() {
                along += transform.tr_mul(&DVector::from_column_slice(r)) * middle;
                counted += 1.0;
            }
        }
        let centre = &transform * (along / counted);
        let errors = equations.regressors().zip(equations.middles());
        let errors = errors.map(|(r, middle)| (product(r, centre.as_slice()) - middle).abs());
        let sigma = errors.filter(|error| error.is_finite()).fold(0.0, f64::max);
        let usable = sigma > 0.0 && transform.iter().chain(&centre).all(|x: &f64| x.is_finite());
        usable.then(|| Self { centre, transform: sigma * transform, sigma })
    }

    /// n . p <= h in these coordinates; lengths in units of sigma.
    pub(super) fn half_space(&self, normal: &[f64], offset: f64) -> HalfSpace {
        let normal = DVector::from_column_slice(normal);
        let white = self.transform.tr_mul(&normal) / self.sigma;
        let offset = (offset - normal.dot(&self.centre)) / self.sigma;
        HalfSpace { normal: white.as_slice().to_vec(), offset }
    }
}
