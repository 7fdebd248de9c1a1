//! A fit as its innovations would have it.
//!
//! The estimator weighs all values alike, which under a random load is not the best use of them:
//! a model that is right may leave larger innovations than one that is wrong, because its
//! parameters were drawn to the slow disturbance. What judges a model is therefore what remains
//! after one Gauss-Newton step of generalised least squares: shared parameters move by what the
//! estimation data say in innovations, and the validation data are judged with that step, their
//! own starts fitted to them.

use nalgebra::DVector;

use super::projection::Projection;
use super::sight::Sight;
use super::whiten::Whitener;

/// Innovations of a model, refined.
pub(crate) struct Refined {
    /// Innovations of the estimation data.
    pub(crate) estimation: Vec<f64>,
    /// Those of the validation data.
    pub(crate) validation: Vec<f64>,
}

impl Refined {
    pub(crate) fn of(estimation: &Sight<'_>, validation: &Sight<'_>, whitener: &Whitener) -> Self {
        let (base, shared) = (estimation.columns(), estimation.shared.len());
        let white = whitener.applied(&base.places, &base.residual);
        let projection = Projection::new(whitener.filtered(&base.places, &base.columns), &white);
        let step = projection.step();
        let other = validation.columns();
        let columns = whitener.filtered(&other.places, &other.columns);
        let mut after = DVector::from_vec(whitener.applied(&other.places, &other.residual));
        after -= columns.rows(0, shared).tr_mul(&step.rows(0, shared));
        let own = columns.rows(shared, columns.nrows() - shared).into_owned();
        let after = Projection::new(own, after.as_slice());
        Self {
            estimation: projection.residual().as_slice().to_vec(),
            validation: after.residual().as_slice().to_vec(),
        }
    }
}
