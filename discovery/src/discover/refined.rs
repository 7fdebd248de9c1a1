//! A fit as its innovations would have it.
//!
//! The estimator weighs all values alike, which under a random load is not the best use of them:
//! a model that is right may leave larger innovations than one that is wrong, because its
//! parameters were drawn to the slow disturbance. What judges a model is therefore what remains
//! after one Gauss-Newton step of generalised least squares: shared parameters move by what the
//! estimation data say in innovations, and the validation data are judged with that step, their
//! own starts fitted to them. The step is a linear one: where teeth knock, a drive may be so far
//! from linear that it makes the validation data worse, and then they are judged without it.

use drivescope_plant::drive::{Drive, EffectData};
use drivescope_plant::effects::registry::Entry;
use nalgebra::DVector;

use super::projection::Projection;
use super::refit::squared;
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
        let own = columns.rows(shared, columns.nrows() - shared).into_owned();
        let unmoved = DVector::from_vec(whitener.applied(&other.places, &other.residual));
        let moved = &unmoved - columns.rows(0, shared).tr_mul(&step.rows(0, shared));
        let fitted = |own, innovations: &DVector<f64>| {
            Projection::new(own, innovations.as_slice()).residual().as_slice().to_vec()
        };
        let still = knocks(estimation.at.drive).then(|| fitted(own.clone(), &unmoved));
        let moved = fitted(own, &moved);
        let better = still.filter(|still| squared(still) < squared(&moved));
        let validation = better.unwrap_or(moved);
        Self { estimation: projection.residual().as_slice().to_vec(), validation }
    }
}

fn knocks(drive: &Drive) -> bool {
    let entry = |effect: &EffectData| Entry::find(&effect.kind);
    drive.effects.iter().filter_map(entry).any(|entry| entry.info.knocks)
}
