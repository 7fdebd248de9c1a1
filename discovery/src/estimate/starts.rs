//! The search from several starts: the values of the balances, the drive's own, and points drawn
//! around the best.

use std::cell::Cell;

use drivescope_numerics::{Limits, Residuals};
use drivescope_plant::drive::Drive;
use drivescope_plant::integrate::MOST_SUBSTEPS;
use rand::SeedableRng;
use rand::distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use super::problem::Problem;
use super::search::{Found, minimise_within};
use super::unknowns::{Unknown, Unknowns};
use super::{Options, Seen};
use crate::case::Case;
use crate::error::Error;

/// Error over the noise floor up to which a search has found it and no further start is tried.
const AT_THE_FLOOR: f64 = 1.05;
/// Points that are looked at for each further start.
const LOOKED_AT: usize = 8;
/// Sums of squares that differ by less, relative, are of one minimum.
const ALIKE: f64 = 1e-4;
/// Relative gain below which the earlier of two ends stays: that of the balances does not depend on
/// the drive's own values, and what is built on it should not either.
const SAME: f64 = 1e-6;
/// Further starts lie within this factor of the best values.
const AROUND: f64 = 3.0;

/// The best minimum from up to that many starts, and how many were tried: the guess, the values of
/// `own`, and points around the best so far. Once two starts have ended alike there is no need for
/// another.
pub(super) fn search(
    problem: &Problem<'_>,
    own: &Drive,
    options: &Options,
    seen: Seen<'_>,
) -> Result<(Found, usize), Error> {
    let reaches = problem.unknowns.reaches();
    let values = problem.evidence.values() as f64;
    let least = Cell::new(f64::INFINITY);
    // Of several starts the best error so far is what falls.
    let report = |sse: f64| {
        least.set(least.get().min(sse));
        seen((least.get() / values).sqrt())
    };
    let limits = Limits { steps: options.steps, relative_decrease: options.worth_a_step / values };
    let from = |start: &[f64]| minimise_within(problem, start, &reaches, limits, &report);
    let mut random = Pcg64::seed_from_u64(options.seed);
    let mut best = from(&problem.unknowns.guess);
    let mut tried = 1;
    let floors = problem.evidence.recordings.iter().map(|it| problem.setting.observer.floor(it));
    let floor = AT_THE_FLOOR * floors.fold(1.0, f64::max);
    let mut confirmed = false;
    while tried < options.starts
        && !confirmed
        && (best.at.sse / values).sqrt().total_cmp(&floor).is_gt()
    {
        let start = if tried == 1 {
            problem.unknowns.with_values_of(own)
        } else {
            let drawn =
                (0..LOOKED_AT).map(|_| around(&problem.unknowns, &best.coordinates, &mut random));
            let looked = drawn.map(|point| (problem.sse(&point), point));
            let Some((_, start)) = looked.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            start
        };
        let found = from(&start);
        confirmed = (found.at.sse / best.at.sse - 1.0).abs() < ALIKE;
        if found.at.sse < (1.0 - SAME) * best.at.sse || !best.at.sse.is_finite() {
            best = found;
        }
        tried += 1;
    }
    if best.at.sse.is_finite() {
        return Ok((best, tried));
    }
    let first = &problem.evidence.recordings[0];
    let (recording, period_s) = (first.name.clone(), first.period_s);
    let substeps = period_s / problem.setting.longest_s;
    if substeps > MOST_SUBSTEPS as f64 {
        return Err(Error::OutOfBudget { recording, period_s, substeps, most: MOST_SUBSTEPS });
    }
    Err(Error::Overflow { recording, starts: tried, laws: overflowing(problem) })
}

/// The typed laws of the drive without any one of which it does not overflow.
fn overflowing(problem: &Problem<'_>) -> Vec<String> {
    let typed = problem.base.effects.iter().filter(|effect| effect.law.is_some());
    let runs_without = |id: &String| {
        let recordings = 0..problem.evidence.recordings.len();
        recordings.into_iter().all(|number| {
            problem.with_case(number, &problem.unknowns.guess, |case| {
                let mut drive = case.drive.clone();
                drive.effects.retain(|effect| effect.id != *id);
                Case { drive: &drive, ..*case }.squares().sum.is_finite()
            })
        })
    };
    typed.map(|effect| effect.id.clone()).filter(runs_without).collect()
}

/// A start drawn around coordinates: parameters within a factor, states as they are.
fn around(unknowns: &Unknowns, coordinates: &[f64], random: &mut Pcg64) -> Vec<f64> {
    let range = Uniform::new_inclusive(-AROUND.ln(), AROUND.ln()).expect("a range");
    let draw = |k: usize| {
        let factor = range.sample(random).exp();
        let (guess, scale) = (coordinates[k], &unknowns.scales[k]);
        match unknowns.all[k] {
            Unknown::Start { .. } => guess,
            _ => scale.coordinate(scale.value(guess) * factor),
        }
    };
    (0..unknowns.all.len()).map(draw).collect()
}
