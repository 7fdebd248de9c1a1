//! Whether what is locked to the position keeps its phase from recording to recording.
//!
//! A ripple that belongs to the machine has one phase. Where the angle has no common origin, or
//! the ripple is a resonance or a supply's, its phase must be estimated anew in each recording:
//! such a ripple is reported, not added.

use super::candidates::Candidate;
use super::columns::{Columns, Owned};
use super::gates;
use super::projection::Projection;
use super::refit::Model;
use super::whiten::Whitener;
use crate::estimate::Evidence;

/// By how many degrees the phase of the candidate in the validation recordings differs from that
/// of the fit; nothing if it has no phase, or theirs is not beyond chance or near.
pub(crate) fn turned(model: &Model, candidate: &Candidate, validation: &Evidence) -> Option<f64> {
    let names: Vec<String> =
        ["a", "b"].iter().map(|name| format!("{}.{name}", candidate.id)).collect();
    if candidate.coefficients != ["a", "b"] {
        return None;
    }
    let all = model.fitted.drive.parameters();
    let value = |name: &String| all.iter().find(|it| it.name == *name).map(|it| it.value);
    let (a, b) = (value(&names[0])?, value(&names[1])?);
    let at = model.validation_sight(validation).at;
    let base = Columns::base(&at, &[]);
    let rows = at
        .rows(&Clone::clone, at.setting, |_| names.iter().cloned().map(Owned::Parameter).collect());
    let columns = Columns::shared(validation, &rows).columns;
    let whitener = Whitener::of(&base.places, &base.residual);
    let white = whitener.applied(&base.places, &base.residual);
    let filtered = whitener.filtered(&base.places, &base.columns);
    let explained =
        Projection::new(filtered, &white).explain(&whitener.filtered(&base.places, &columns));
    let price = 2.0 * (white.len() as f64).ln();
    if explained.gain - price <= gates::DELTA_BIC {
        return None;
    }
    let (c, d) = (a + explained.coefficients[0], b + explained.coefficients[1]);
    let cosine = (a * c + b * d) / (a.hypot(b) * c.hypot(d));
    (cosine < gates::PHASE).then(|| cosine.clamp(-1.0, 1.0).acos().to_degrees())
}
