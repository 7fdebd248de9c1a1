//! A fit as its innovations would have it.
//!
//! The estimator weighs all values alike, which under a random load is not the best use of them:
//! a model that is right may leave larger innovations than one that is wrong, because its
//! parameters were drawn to the slow disturbance. What judges a model is therefore what remains
//! after one Gauss-Newton step of generalised least squares: shared parameters move by what the
//! estimation data say in innovations, and the validation data are judged with that step, their
//! own starts fitted to them.

use nalgebra::DVector;

use super::columns::{At, Columns, Place};
use super::projection::Projection;
use super::refit::Model;
use super::whiten::Whitener;
use crate::estimate::Evidence;

/// Innovations of a model, refined.
pub(crate) struct Refined {
    /// Where those of the estimation data were measured.
    pub(crate) places: Vec<Place>,
    /// Innovations of the estimation data.
    pub(crate) estimation: Vec<f64>,
    /// Those of the validation data.
    pub(crate) validation: Vec<f64>,
}

impl Refined {
    pub(crate) fn of(
        model: &Model,
        estimation: &Evidence,
        validation: &Evidence,
        whitener: &Whitener,
    ) -> Self {
        let names = model.names();
        let base = Columns::base(&model.at(estimation), &names);
        let white = whitener.applied(&base.places, &base.residual);
        let projection = Projection::new(whitener.filtered(&base.places, &base.columns), &white);
        let step = projection.step();
        let other = Columns::base(&model.at_validation(validation), &names);
        let columns = whitener.filtered(&other.places, &other.columns);
        let mut after = DVector::from_vec(whitener.applied(&other.places, &other.residual));
        after -= columns.rows(0, names.len()).tr_mul(&step.rows(0, names.len()));
        let own = columns.rows(names.len(), columns.nrows() - names.len()).into_owned();
        let after = Projection::new(own, after.as_slice());
        Self {
            places: base.places,
            estimation: projection.residual().as_slice().to_vec(),
            validation: after.residual().as_slice().to_vec(),
        }
    }
}

/// The filter to innovations that the residual of a model asks for.
pub(crate) fn whitener(at: &At<'_>) -> Whitener {
    let rows = Columns::residuals(at);
    Whitener::of(&rows.places, &rows.residual)
}
