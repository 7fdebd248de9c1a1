//! What is left of a residual, by curves: how much each could take away, and where.

use std::sync::LazyLock;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::columns::{Columns, Place};
use super::curves::{Curve, curves, response};
use super::gates;
use super::projection::{Explained, Projection};
use super::refit::{p_value, squared};
use super::scales::Scales;
use super::sight::Sight;
use super::smooth::{smooth, told};
use super::whiten::Whitener;
use crate::estimate::Evidence;

/// What a curve could remove.
#[derive(Debug, Clone)]
pub(crate) struct Rest {
    /// The curve.
    pub(crate) curve: Curve,
    /// Its values at the knots, the smoothest that explain as much.
    pub(crate) values: Vec<f64>,
    /// Which of them these recordings tell.
    pub(crate) told: Vec<bool>,
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
    /// Of a drive at the recordings it was fitted to, and at others to judge by.
    pub(crate) fn of(
        sight: &Sight<'_>,
        validation: &Sight<'_>,
        scales: &Scales,
        stopped: &(dyn Fn() -> bool + Sync),
    ) -> Self {
        let (at, base, runs) = (&sight.at, sight.columns(), sight.runs());
        let all = curves(at.drive, scales, runs);
        let plain = Projection::new(base.columns.clone(), &base.residual);
        // Responses are made twice rather than kept: all of a long recording fill the memory.
        let explained =
            |curve: &Curve| (!stopped()).then(|| plain.explain(&response(at, runs, curve)));
        // What was stopped compares with no curve.
        let raw: Option<Vec<Explained>> = all.par_iter().map(explained).collect();
        let (all, raw) = raw.map_or_else(Default::default, |raw| (all, raw));
        let best = (0..all.len()).max_by(|a, b| raw[*a].gain.total_cmp(&raw[*b].gain));
        let after = best.map(|best| {
            let change = plain.change(&response(at, runs, &all[best]), &raw[best].coefficients);
            (plain.residual() - change).as_slice().to_vec()
        });
        let whitener = Whitener::of(&base.places, after.as_ref().unwrap_or(&base.residual));
        let white = whitener.applied(&base.places, &base.residual);
        let projection = Projection::new(whitener.filtered(&base.places, &base.columns), &white);
        let other = LazyLock::new(|| Other::new(validation, &whitener));
        let rests = all.into_par_iter().zip(&raw).map(|(curve, raw)| {
            let columns = whitener.filtered(&base.places, &response(at, runs, &curve));
            let explained = projection.explain(&columns);
            let before = projection.residual().as_slice();
            let after =
                projection.residual() - projection.change(&columns, &explained.coefficients);
            let block = blocks(at.evidence, gates::BLOCK_S);
            let p = p_value(&base.places, before, after.as_slice(), explained.rank, block);
            let gain = explained.gain - explained.rank as f64;
            let products = projection.products(&columns);
            let values = smooth(&products, curve.period.is_some(), base.residual.len());
            let told = told(&products, &values);
            // What is not worth its price is not worth the run over the validation data either.
            let worth = gain - explained.rank as f64 * (base.residual.len() as f64).ln();
            let validation_gain = if worth > 0.0 {
                let shift = projection.shift(&columns, &values);
                let shift = &shift.as_slice()[..sight.shared.len()];
                other.gain(&curve, &whitener, &values, shift)
            } else {
                0.0
            };
            Rest {
                curve,
                values: values.as_slice().to_vec(),
                told,
                removed: raw.gain - raw.rank as f64,
                gain,
                rank: explained.rank,
                p_value: p,
                validation_gain,
            }
        });
        let rests = rests.collect();
        drop(other);
        Self { rests, whitener, power: squared(&base.residual), values: base.residual.len() }
    }

    /// Squared error above the floor.
    pub(crate) fn excess(&self, floor: f64) -> f64 {
        (self.power - floor).max(1.0)
    }

    /// The curves that are worth their price, as a candidate has to be, and repeat: what a rich
    /// curve takes away by chance is no evidence for its shape.
    pub(crate) fn worthy(&self, floor: f64) -> impl Iterator<Item = &Rest> {
        let excess = self.excess(floor);
        let price = (self.values as f64).ln() - 1.0;
        self.rests.iter().filter(move |rest| {
            let repeats = if rest.curve.is_over_time() {
                rest.removed > gates::OVER_TIME * excess
            } else {
                rest.validation_gain > 0.0
            };
            rest.gain - rest.rank as f64 * price > gates::DELTA_BIC && repeats
        })
    }

    /// The curve beyond chance that removes most, if there is any; one that can be added stands
    /// before one that cannot and removes little more.
    pub(crate) fn unknown(&self, floor: f64) -> Option<&Rest> {
        let chance = |rest: &Rest| rest.p_value * self.rests.len() as f64;
        // Rich curves have hardly fewer hats than a short recording has blocks.
        let plainly = |rest: &Rest| {
            rest.validation_gain > gates::REPEATS && rest.removed > gates::PLAINLY * self.power
        };
        let beyond = |rest: &&Rest| chance(rest) < gates::P_VALUE || plainly(rest);
        let mut some: Vec<&Rest> = self.worthy(floor).filter(beyond).collect();
        some.sort_by(|a, b| b.removed.total_cmp(&a.removed));
        let best = *some.first()?;
        let addable = some.iter().find(|rest| rest.curve.is_addable());
        addable.filter(|it| it.removed >= gates::ADDABLE * best.removed).or(Some(&best)).copied()
    }

    /// The curve to add where the user asks for one: the unknown one if it can be added, or what
    /// removes most of those that lower the error on the validation data too.
    pub(crate) fn addable(&self, floor: f64) -> Option<&Rest> {
        let addable = |rest: &&Rest| rest.curve.is_addable();
        self.unknown(floor).filter(addable).or_else(|| {
            let repeats = |rest: &&Rest| rest.curve.is_addable() && rest.validation_gain > 0.0;
            let some = self.rests.iter().filter(repeats);
            some.max_by(|a, b| a.removed.total_cmp(&b.removed))
        })
    }
}

/// The validation recordings, ready to be explained.
struct Other<'a> {
    sight: &'a Sight<'a>,
    /// Innovations, and columns of what is shared in them.
    white: Vec<f64>,
    base: DMatrix<f64>,
}

impl<'a> Other<'a> {
    fn new(sight: &'a Sight<'a>, whitener: &Whitener) -> Self {
        let Columns { places, residual, columns } = sight.columns();
        let columns = columns.rows(0, sight.shared.len()).into_owned();
        let white = whitener.applied(places, residual);
        Self { sight, white, base: whitener.filtered(places, &columns) }
    }

    /// Squared innovations that the curve takes away, with what it shifts in the base.
    fn gain(
        &self,
        curve: &Curve,
        whitener: &Whitener,
        values: &DVector<f64>,
        shift: &[f64],
    ) -> f64 {
        let response = response(&self.sight.at, self.sight.runs(), curve);
        let columns = whitener.filtered(&self.sight.columns().places, &response);
        let mut after = DVector::from_column_slice(&self.white);
        after -= columns.tr_mul(values);
        after -= self.base.tr_mul(&DVector::from_column_slice(shift));
        squared(&self.white) - after.norm_squared()
    }
}
