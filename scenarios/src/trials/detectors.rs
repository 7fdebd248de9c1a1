//! The paper's detectors at equal mean times between false alarms, beside bank and known model.
//!
//! A band has a level beta, and a decision after 50 exceedances in a row; neither is a mean time
//! between false alarms. So each is taken as what it measures: the least of the last 50 distances
//! from the middle of the band, in half widths. It declares a fault where that is above a limit; at
//! limit 1 this is the paper's rule, and other limits are designed from the tail over healthy machines,
//! as the bank's are. Every detector gets the same baseline of each machine: its mean residual there is
//! taken off. A sequential test has no such distance, and is not among them.

use drivescope_diagnoser::DetectorError;
use drivescope_diagnoser::bank::{Tail, Verified};
use rayon::prelude::*;
use serde::Serialize;

use super::along::Along;
use super::bench::{Bench, fault};
use super::course::WATCHED;
use super::delays::{AFTER, DelayRow, FAULTS, delays};
use super::healthy::{HealthyRow, held};
use super::machine::{Group, Plan};
use super::{ARL_0, TrialError};
use crate::profile::Profile;
use crate::results::DetectorKind;
use crate::shares::{Share, Spread};
use crate::study::Designed;

/// Samples after which another exceedance is another alarm.
const APART: usize = 400;
/// The null: nothing fails.
const NOTHING: (&str, f64) = ("nothing", 0.0);
/// Machines that are watched at once.
const SOME: usize = 32;
/// Healthy machines that limits are designed on.
const DESIGN_MACHINES: usize = 15;

/// A detector at each mean time between false alarms.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DetectorRow {
    /// `bank`, or the method of the paper.
    pub detector: String,
    /// Limits, in half widths of the paper's bands; none for the bank, which has two statistics.
    pub limits: Option<[f64; ARL_0.len()]>,
    /// False alarms in so many fresh healthy samples at each limit.
    pub samples: usize,
    /// Their counts.
    pub alarms: [usize; ARL_0.len()],
    /// Lower 95 % limits of the mean samples between them.
    pub arl_0_at_least: [f64; ARL_0.len()],
    /// Of each fault, detected shares and delays at each limit.
    pub faults: Vec<FaultDelays>,
}

/// One fault under one detector.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaultDelays {
    pub mechanism: String,
    /// Magnitude.
    pub size: f64,
    /// Machines on which it was detected within the run, at each limit.
    pub detected: [Share; ARL_0.len()],
    /// Delays where it was, samples.
    pub delay: [Spread; ARL_0.len()],
}

/// All detectors, and the limit for any.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curves {
    /// Designed mean samples between false alarms.
    pub arl_0: [f64; ARL_0.len()],
    /// Machines of each row.
    pub machines: usize,
    /// Samples that a fault is watched for.
    pub watched: usize,
    /// The bank, then the paper's.
    pub detectors: Vec<DetectorRow>,
    /// The bank beside a detector that knows machine and mechanism.
    pub known: Vec<DelayRow>,
    /// A detector that always alarms: it detects nothing, for it does so before the fault.
    pub always: FaultDelays,
}

/// Alarms of a statistic at each limit.
fn alarms(values: &[f64], limits: &[f64; ARL_0.len()]) -> [usize; ARL_0.len()] {
    limits.map(|limit| {
        let mut last: Option<usize> = None;
        let over = values.iter().enumerate().filter(|(_, value)| **value > limit);
        let apart = over.filter(|(at, _)| {
            let new = last.is_none_or(|last| *at > last + APART);
            last = Some(*at);
            new
        });
        apart.count()
    })
}

/// Samples from the onset to the first value over each limit; nothing where it never is, or was before.
fn first_over(values: &[f64], onset: usize, limits: &[f64; ARL_0.len()]) -> Found {
    let (before, after) = values.split_at(onset);
    limits.map(|limit| {
        let early = before.iter().any(|value| *value > limit);
        after.iter().position(|value| *value > limit).filter(|_| !early)
    })
}

/// Delays of one fault at each limit.
type Found = [Option<usize>; ARL_0.len()];

/// Rows of one fault from what machines gave.
fn of_fault(mechanism: &str, size: f64, found: &[Found]) -> FaultDelays {
    let delays = |k: usize| found.iter().filter_map(move |of| of[k]);
    FaultDelays {
        mechanism: mechanism.to_owned(),
        size,
        detected: std::array::from_fn(|k| Share::new(delays(k).count(), found.len())),
        delay: std::array::from_fn(|k| Spread::of(delays(k).map(|delay| delay as f64))),
    }
}

/// Healthy runs of machines at the set point that was shown.
fn healthy_values(
    bench: &Bench,
    designed: &Designed,
    method: DetectorKind,
    machines: std::ops::Range<usize>,
) -> Result<Vec<Vec<f64>>, TrialError> {
    let (baseline, per_si) = lengths(bench);
    let numbers = machines.into_par_iter();
    let values = numbers.map(|number| {
        let machine = bench.machine(Group::Curves, number);
        let reference = vec![machine.experiment.set_point; baseline + WATCHED];
        let runs = machine.rows(&[Plan { reference, faults: Vec::new() }]);
        Ok(Along::over(designed, method, (&runs[0], baseline, per_si))?)
    });
    values.collect()
}

/// Samples of a baseline, and the unit of the tachometer.
fn lengths(bench: &Bench) -> (usize, f64) {
    let per_si = bench.experiment.drive.sensors.tacho_unit.per_si();
    (bench.designed.how.baseline, per_si)
}

fn of_paper(
    bench: &Bench,
    designed: &Designed,
    method: DetectorKind,
    machines: usize,
) -> Result<DetectorRow, TrialError> {
    let design = healthy_values(bench, designed, method, 0..DESIGN_MACHINES)?;
    let tail = Tail::of(design.into_iter().flatten())?;
    let limits = ARL_0.map(|arl_0| tail.limit(arl_0));
    // A few at a time: all of them would not fit in memory.
    let fresh = DESIGN_MACHINES..DESIGN_MACHINES + machines;
    let mut counted = [0; ARL_0.len()];
    for first in fresh.clone().step_by(SOME) {
        let some = first..fresh.end.min(first + SOME);
        for values in healthy_values(bench, designed, method, some)? {
            counted.iter_mut().zip(alarms(&values, &limits)).for_each(|(all, n)| *all += n);
        }
    }
    let (baseline, per_si) = lengths(bench);
    let mut faults = Vec::new();
    // The last is a machine on which nothing fails, called faulty.
    for (number, (mechanism, size)) in FAULTS.into_iter().chain([NOTHING]).enumerate() {
        let found = bench.each(Group::Delays, bench.machines, |machine, _| {
            machine.renew_noise(number);
            let onset = machine.onset(bench);
            let reference = vec![machine.experiment.set_point; onset + AFTER];
            let size = machine.sign() * size;
            let faults = match mechanism == NOTHING.0 {
                true => Vec::new(),
                false => vec![fault(mechanism, size, onset, Profile::Step)],
            };
            let runs = machine.rows(&[Plan { reference, faults }]);
            let values = Along::over(designed, method, (&runs[0], baseline, per_si))?;
            Ok(first_over(&values, onset - baseline, &limits))
        });
        let found = found.into_iter().collect::<Result<Vec<Found>, DetectorError>>()?;
        faults.push(of_fault(mechanism, size, &found));
    }
    let samples = machines * WATCHED;
    let at_least = counted.map(|alarms| Verified { samples, alarms }.arl_0_at_least());
    Ok(DetectorRow {
        detector: method.label().to_owned(),
        limits: Some(limits),
        samples,
        alarms: counted,
        arl_0_at_least: at_least,
        faults,
    })
}

/// The bank's row, from its delays and its false alarms at the set point that was shown.
fn of_bank(bench: &Bench, known: &[DelayRow], machines: usize) -> DetectorRow {
    let HealthyRow { samples, alarms, .. } = held(bench, machines);
    let row = |row: &DelayRow| FaultDelays {
        mechanism: row.mechanism.clone(),
        size: row.size,
        detected: std::array::from_fn(|k| row.delays[k].detected),
        delay: std::array::from_fn(|k| row.delays[k].samples),
    };
    DetectorRow {
        detector: "bank of hypotheses".to_owned(),
        limits: None,
        samples,
        alarms,
        arl_0_at_least: alarms.map(|alarms| Verified { samples, alarms }.arl_0_at_least()),
        faults: known.iter().map(row).collect(),
    }
}

/// Those detectors that are a distance from the middle of a band.
pub(super) fn compared() -> impl Iterator<Item = DetectorKind> {
    DetectorKind::ALL.into_iter().filter(|kind| !kind.info().is_sequential)
}

/// The curves of the detectors of a study and of a bank over machines of one kind, with false alarms on
/// `samples` healthy ones; `step` is called after each detector.
pub(super) fn curves(
    bench: &Bench,
    designed: &Designed,
    samples: usize,
    step: &dyn Fn() -> Result<(), TrialError>,
) -> Result<Curves, TrialError> {
    let known = delays(bench)?;
    step()?;
    let machines = samples.div_ceil(WATCHED);
    let mut detectors = vec![of_bank(bench, &known, machines)];
    step()?;
    for method in compared() {
        detectors.push(of_paper(bench, designed, method, machines)?);
        step()?;
    }
    let always = first_over(&vec![f64::INFINITY; AFTER], AFTER / 2, &[0.0; ARL_0.len()]);
    let always = of_fault("always alarming", 0.0, &vec![always; bench.machines]);
    Ok(Curves { arl_0: ARL_0, machines: bench.machines, watched: AFTER, detectors, known, always })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_and_alarms_are_counted_and_an_early_alarm_is_no_detection() {
        let values = [0.0, 0.5, 0.0, 0.0, 2.0, 3.0];
        let limits = [0.4, 1.0, 2.5, 5.0, 5.0, 5.0];
        let found = first_over(&values, 3, &limits);
        assert_eq!(found, [None, Some(1), Some(2), None, None, None]);
        assert_eq!(alarms(&values, &limits), [1, 1, 1, 0, 0, 0]);
        let mut apart = vec![0.0; 2000];
        (apart[10], apart[300], apart[1500]) = (1.0, 1.0, 1.0);
        assert_eq!(alarms(&apart, &[0.5; ARL_0.len()]), [2; ARL_0.len()]);
        let row = of_fault("tacho", 0.05, &[found, [Some(3); ARL_0.len()]]);
        assert_eq!((row.detected[0].hits, row.detected[1].hits), (1, 2));
        assert_eq!((row.delay[1].mean, row.delay[3].mean), (2.0, 3.0));
    }
}
