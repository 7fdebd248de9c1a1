//! What a hidden effect costs: the smallest fault that is detected by a bank whose drive model lacks an
//! effect of the machine, and by the same bank after the effect was added.
//!
//! Both banks learn their noise from the same healthy runs of the machine, in steps between speeds, where
//! an effect that the model lacks cannot hide in a baseline. Their limits are designed on healthy runs of
//! the machine itself for one mean time between false alarms, so that neither buys sensitivity with
//! them; false alarms are counted on others.

use drivescope_diagnoser::bank::{Limits, Row, Tail, TailError, Verified};
use drivescope_plant::drive::Drive;
use serde::{Deserialize, Serialize};

use super::bench::{Bench, NEVER, fault};
use super::course::{Course, WATCHED};
use super::delays::first_over;
use super::machine::{Group, Plan};
use super::{TrialError, TrialOptions};
use crate::profile::Profile;
use crate::shares::Share;

/// Mechanisms that are tried, and sizes, each larger than the last by a half.
const KINDS: [&str; 6] = ["tacho", "flux", "actuator", "resistance", "friction", "load"];
const SMALLEST: f64 = 0.002;
const RATIO: f64 = 1.5;
const SIZES: usize = 15;
/// Samples of a run after the onset: 2 s at 5 ms.
const AFTER: usize = 400;
/// Share of machines that must be detected.
const DETECTED: f64 = 0.9;
/// Mean samples between false alarms.
const ARL_0: f64 = 1e5;
/// Healthy machines for the limits, and as many for the count of false alarms.
const HEALTHY: usize = 15;

/// One mechanism under one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Detectable {
    pub mechanism: String,
    /// Size from which on nine machines in ten are detected within 2 s; none if there is none up to the
    /// largest that was tried.
    pub size: Option<f64>,
    /// Sizes that were tried, and shares of machines detected.
    pub curve: Vec<(f64, f64)>,
}

/// One model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelRows {
    /// Standard deviation of the random load that the bank had to assume, N m (N).
    pub torque_noise: f64,
    /// False alarms in so many healthy samples.
    pub alarms: usize,
    /// These samples.
    pub samples: usize,
    /// Lower 95 % limit of the mean samples between false alarms.
    pub arl_0_at_least: f64,
    /// Healthy machines that the bank learned; 0 where they were too few for its limits, and nothing is
    /// judged.
    pub learned: usize,
    pub mechanisms: Vec<Detectable>,
}

/// The table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HiddenEffect {
    /// Identifier of the effect.
    pub effect: String,
    /// Designed mean samples between false alarms, of both.
    pub arl_0: f64,
    /// Machines of each point of a curve.
    pub machines: usize,
    /// With a model that lacks the effect.
    pub before: ModelRows,
    /// With one that has it.
    pub after: ModelRows,
}

/// Smallest detectable faults of a machine with the model that lacks an effect and with its own; ends
/// where `advance`, called after each mechanism, answers true.
///
/// # Errors
/// [`TrialError`]; [`TrialError::NoEffect`] where the drive has no such effect.
pub fn hidden_effect(
    drive: &Drive,
    effect: &str,
    (machines, seed): (usize, u64),
    advance: &(dyn Fn() -> bool + Sync),
) -> Result<HiddenEffect, TrialError> {
    let mut lacking = drive.clone();
    lacking.effects.retain(|it| it.kind != effect);
    if lacking.effects.len() == drive.effects.len() {
        return Err(TrialError::NoEffect { effect: effect.to_owned() });
    }
    let options = TrialOptions { machines, healthy: 0, arl_0: ARL_0, seed };
    let rows = |model: &Drive| -> Result<ModelRows, TrialError> {
        let bench = Bench::with_model(drive.clone(), model, &options, Course::Steps)?;
        of_model(&bench, advance)
    };
    let (before, after) = (rows(&lacking)?, rows(drive)?);
    Ok(HiddenEffect { effect: effect.to_owned(), arl_0: ARL_0, machines, before, after })
}

/// Steps of [`hidden_effect`], for a progress bar.
pub const HIDDEN_STEPS: u64 = 2 * KINDS.len() as u64;

fn of_model(bench: &Bench, advance: &(dyn Fn() -> bool + Sync)) -> Result<ModelRows, TrialError> {
    let Some(limits) = limits(bench) else { return detects_nothing(bench, advance) };
    let process = bench.designed.process.as_ref();
    let counted = bench.each(Group::Healthy, HEALTHY, |machine, _| {
        let reference = Course::Steps.reference(bench, machine);
        let runs = machine.rows(&[Plan { reference, faults: Vec::new() }]);
        over(bench, &limits, &runs[0])
    });
    let learned = counted.iter().flatten().count();
    let (alarms, samples) = (counted.iter().flatten().sum(), learned * WATCHED);
    let mut mechanisms = Vec::new();
    for (number, kind) in KINDS.iter().enumerate() {
        let found = bench.each(Group::Hidden, bench.machines, |machine, _| {
            machine.renew_noise(number);
            let onset = machine.onset(bench);
            let mut reference = Course::Steps.reference(bench, machine);
            reference.truncate(onset + AFTER);
            let sign = machine.sign();
            let plan = |step: usize| Plan {
                reference: reference.clone(),
                faults: vec![fault(kind, sign * size(step), onset, Profile::Step)],
            };
            let plans: Vec<Plan> = (0..SIZES).map(plan).collect();
            let detected =
                |rows: &Vec<Row>| first_over(bench, process, &[limits], rows, onset)[0].is_some();
            machine.rows(&plans).iter().map(detected).collect::<Vec<bool>>()
        });
        let share = |step: usize| {
            let hits = found.iter().filter(|machine| machine[step]).count();
            Share::new(hits, found.len()).share
        };
        let curve: Vec<(f64, f64)> = (0..SIZES).map(|step| (size(step), share(step))).collect();
        let mechanism = (*kind).to_owned();
        mechanisms.push(Detectable { mechanism, size: reached(&curve), curve });
        if advance() {
            return Err(TrialError::Stopped);
        }
    }
    Ok(ModelRows {
        torque_noise: bench.designed.noise.torque,
        alarms,
        samples,
        arl_0_at_least: Verified { samples, alarms }.arl_0_at_least(),
        learned,
        mechanisms,
    })
}

/// Size of that number.
fn size(step: usize) -> f64 {
    SMALLEST * RATIO.powf(step as f64)
}

/// The rows of a model that is so far from the machine that most baselines are refused: a bank that has
/// not learned its machine judges nothing.
fn detects_nothing(
    bench: &Bench,
    advance: &(dyn Fn() -> bool + Sync),
) -> Result<ModelRows, TrialError> {
    let curve: Vec<(f64, f64)> = (0..SIZES).map(|step| (size(step), 0.0)).collect();
    if KINDS.iter().any(|_| advance()) {
        return Err(TrialError::Stopped);
    }
    let of = |kind: &&str| Detectable {
        mechanism: (*kind).to_owned(),
        size: None,
        curve: curve.clone(),
    };
    Ok(ModelRows {
        torque_noise: bench.designed.noise.torque,
        alarms: 0,
        samples: 0,
        arl_0_at_least: 0.0,
        learned: 0,
        mechanisms: KINDS.iter().map(of).collect(),
    })
}

/// Limits for the designed time between false alarms on healthy runs of the machine itself; nothing where
/// the bank learns too few machines for them.
fn limits(bench: &Bench) -> Option<Limits> {
    let process = bench.designed.process.as_ref();
    let statistics = bench.each(Group::Curves, HEALTHY, |machine, _| {
        let reference = Course::Steps.reference(bench, machine);
        let runs = machine.rows(&[Plan { reference, faults: Vec::new() }]);
        let watched = bench.watch(process, NEVER, &runs[0]);
        watched.map_or_else(Vec::new, |(mut watch, rows)| {
            let of_row = |row: &Row| {
                watch.step(row);
                let found = watch.statistics();
                [found.ratio, found.squares]
            };
            rows.iter().map(of_row).collect::<Vec<[f64; 2]>>()
        })
    });
    // Two statistics share the false alarms.
    let of = |which: usize| -> Result<f64, TailError> {
        let values = statistics.iter().flatten().map(|of| of[which]);
        Ok(Tail::of(values)?.limit(2.0 * ARL_0))
    };
    match (of(0), of(1)) {
        (Ok(ratio), Ok(squares)) => Some(Limits { ratio, squares }),
        (Err(TailError::TooFew { .. }), _) | (_, Err(TailError::TooFew { .. })) => None,
    }
}

/// Alarms over the rows after a baseline; nothing where it is refused.
fn over(bench: &Bench, limits: &Limits, rows: &[Row]) -> Option<usize> {
    /// Samples after which another exceedance is another alarm.
    const APART: usize = 400;
    let (mut watch, rest) = bench.watch(bench.designed.process.as_ref(), NEVER, rows)?;
    let (mut alarms, mut last) = (0, None::<usize>);
    for (at, row) in rest.iter().enumerate() {
        watch.step(row);
        let found = watch.statistics();
        if found.ratio > limits.ratio || found.squares > limits.squares {
            alarms += usize::from(last.is_none_or(|last| at > last + APART));
            last = Some(at);
        }
    }
    Some(alarms)
}

/// The size at which a curve reaches the asked share for good, between the points by their logarithms.
fn reached(curve: &[(f64, f64)]) -> Option<f64> {
    let last_below = curve.iter().rposition(|(_, share)| *share < DETECTED);
    let Some(below) = last_below else { return curve.first().map(|(size, _)| *size) };
    let ((s0, p0), (s1, p1)) = (*curve.get(below)?, *curve.get(below + 1)?);
    let part = (DETECTED - p0) / (p1 - p0);
    Some(s0 * (s1 / s0).powf(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_size_lies_where_the_curve_stays_above() {
        let curve = [(0.01, 0.1), (0.02, 0.95), (0.04, 0.5), (0.08, 1.0), (0.16, 1.0)];
        let size = reached(&curve).expect("it is reached");
        assert!((0.06..0.08).contains(&size), "{size}");
        assert_eq!(reached(&curve[..3]), None);
        assert_eq!(reached(&[(0.01, 1.0), (0.02, 1.0)]), Some(0.01));
    }
}
