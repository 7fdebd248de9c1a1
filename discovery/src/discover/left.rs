//! What is left of a residual, by curves: how much each could take away, and where.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::columns::{At, Columns, Place};
use super::curves::{Curve, curves, responses};
use super::gates;
use super::projection::{Explained, Projection};
use super::refit::{p_value, squared};
use super::report::Where;
use super::ripple::trajectories;
use super::scales::Scales;
use super::whiten::Whitener;
use crate::estimate::Evidence;

/// What a curve could remove.
#[derive(Debug, Clone)]
pub(crate) struct Rest {
    /// The curve.
    pub(crate) curve: Curve,
    /// Its values at the knots.
    pub(crate) values: Vec<f64>,
    /// Squared error, less one a hat.
    pub(crate) removed: f64,
    /// Squared innovations, less one a hat.
    pub(crate) gain: f64,
    /// Hats that count.
    pub(crate) rank: usize,
    /// p value of the block-robust test.
    pub(crate) p_value: f64,
    /// Squared innovations that go on the validation recordings, as it stands.
    pub(crate) validation_gain: f64,
}

/// What is left, by every curve, in the innovations of the best of them.
#[derive(Debug, Clone)]
pub(crate) struct Left {
    pub(crate) rests: Vec<Rest>,
    pub(crate) whitener: Whitener,
    /// Squared error of the residual.
    pub(crate) power: f64,
    values: usize,
}

/// Number of the block of time that a value lies in.
pub(crate) fn blocks(evidence: &Evidence, block_s: f64) -> impl Fn(&Place) -> usize + '_ {
    move |place| {
        let period_s = evidence.recordings[place.recording].period_s;
        let samples = ((block_s / period_s).round() as usize).max(1);
        (place.recording << 32) + place.sample / samples
    }
}

impl Left {
    /// Of a fitted drive; `shared` are its parameters that were fitted, `validation` the same
    /// drive on other recordings.
    pub(crate) fn of(
        at: &At<'_>,
        base: &Columns,
        shared: &[String],
        validation: &At<'_>,
        scales: &Scales,
        stopped: &(dyn Fn() -> bool + Sync),
    ) -> Self {
        let runs = trajectories(at);
        let periods: Vec<f64> = at.evidence.recordings.iter().map(|one| one.period_s).collect();
        let all = curves(at.drive, scales, &periods, &runs);
        let responses = responses(at, &runs, &all, stopped);
        let plain = Projection::new(base.columns.clone(), &base.residual);
        let raw: Vec<Explained> =
            responses.par_iter().map(|columns| plain.explain(columns)).collect();
        let best = (0..all.len()).max_by(|a, b| raw[*a].gain.total_cmp(&raw[*b].gain));
        let after = best.map(|best| {
            let beside = plain.beside(&responses[best]);
            plain.after(&beside, &raw[best].coefficients).as_slice().to_vec()
        });
        let whitener = Whitener::of(&base.places, after.as_ref().unwrap_or(&base.residual));
        let white = whitener.applied(&base.places, &base.residual);
        let projection = Projection::new(whitener.filtered(&base.places, &base.columns), &white);
        let other = Other::new(validation, shared, &whitener);
        let rests = all.into_par_iter().zip(&responses).zip(&raw).map(|((curve, columns), raw)| {
            let columns = whitener.filtered(&base.places, columns);
            let explained = projection.explain(&columns);
            let beside = projection.beside(&columns);
            let before = projection.residual().as_slice();
            let after = projection.after(&beside, &explained.coefficients);
            let block = blocks(at.evidence, gates::BLOCK_S);
            let p = p_value(&base.places, before, after.as_slice(), explained.rank, block);
            let gain = explained.gain - explained.rank as f64;
            // What is not worth its price is not worth the run over the validation data either.
            let worth = gain - explained.rank as f64 * (base.residual.len() as f64).ln();
            let validation_gain = if worth > 0.0 {
                let shift = projection.shift(&columns, &explained.coefficients);
                other.gain(
                    validation,
                    &curve,
                    &whitener,
                    &explained,
                    &shift.as_slice()[..shared.len()],
                )
            } else {
                0.0
            };
            Rest {
                curve,
                values: explained.coefficients.as_slice().to_vec(),
                removed: raw.gain - raw.rank as f64,
                gain,
                rank: explained.rank,
                p_value: p,
                validation_gain,
            }
        });
        let rests = rests.collect();
        Self { rests, whitener, power: squared(&base.residual), values: base.residual.len() }
    }

    /// Squared error above the floor.
    pub(crate) fn excess(&self, floor: f64) -> f64 {
        (self.power - floor).max(1.0)
    }

    /// The curves that are worth their price, as a candidate has to be: what a rich curve takes
    /// away by chance is no evidence for its shape.
    pub(crate) fn worthy(&self) -> impl Iterator<Item = &Rest> {
        let price = (self.values as f64).ln() - 1.0;
        self.rests
            .iter()
            .filter(move |rest| rest.gain - rest.rank as f64 * price > gates::DELTA_BIC)
    }

    /// The curve beyond chance that removes most, if there is any.
    pub(crate) fn unknown(&self, floor: f64) -> Option<&Rest> {
        let excess = self.excess(floor);
        let beyond = |rest: &&Rest| {
            let repeats = if rest.curve.is_over_time() {
                rest.removed > gates::OVER_TIME * excess
            } else {
                rest.validation_gain > 0.0
            };
            rest.p_value * (self.rests.len() as f64) < gates::P_VALUE && repeats
        };
        self.worthy().filter(beyond).max_by(|a, b| a.removed.total_cmp(&b.removed))
    }

    /// Variables over which the model fails, most telling first.
    pub(crate) fn fails(&self, floor: f64) -> Vec<Where> {
        let excess = self.excess(floor);
        let mut fails: Vec<Where> = Vec::new();
        for rest in &self.rests {
            let p_value = (rest.p_value * self.rests.len() as f64).min(1.0);
            let variable = rest.curve.variables()[0].name();
            let share = (rest.removed / excess).clamp(0.0, 1.0);
            let one = Where { variable, p_value, share };
            match fails.iter_mut().find(|it| it.variable == variable) {
                Some(it) if it.share < share => *it = one,
                Some(_) => {}
                None => fails.push(one),
            }
        }
        fails.sort_by(|a, b| b.share.total_cmp(&a.share));
        fails
    }
}

/// The validation recordings, ready to be explained.
struct Other {
    runs: Vec<super::ripple::Trajectory>,
    base: DMatrix<f64>,
    white: Vec<f64>,
    places: Vec<Place>,
}

impl Other {
    fn new(at: &At<'_>, shared: &[String], whitener: &Whitener) -> Self {
        let base = Columns::base(at, shared);
        let columns = base.columns.rows(0, shared.len()).into_owned();
        let white = whitener.applied(&base.places, &base.residual);
        let filtered = whitener.filtered(&base.places, &columns);
        Self { runs: trajectories(at), base: filtered, white, places: base.places }
    }

    /// Squared innovations that the curve takes away, with what it shifts in the base.
    fn gain(
        &self,
        at: &At<'_>,
        curve: &Curve,
        whitener: &Whitener,
        explained: &Explained,
        shift: &[f64],
    ) -> f64 {
        let response = responses(at, &self.runs, std::slice::from_ref(curve), &|| false);
        let columns = whitener.filtered(&self.places, &response[0]);
        let mut after = nalgebra::DVector::from_column_slice(&self.white);
        after -= columns.tr_mul(&explained.coefficients);
        after -= self.base.tr_mul(&nalgebra::DVector::from_column_slice(shift));
        squared(&self.white) - after.norm_squared()
    }
}
