//! Delays against the mean time between false alarms, beside a detector that knows the machine and
//! what fails, but not since when and by how much: the generalised likelihood ratio of one mechanism
//! on the true equations is the limit for any other.

use drivescope_diagnoser::bank::{Limits, Row, Tail};
use drivescope_plant::fault::MECHANISMS;
use serde::Serialize;

use super::bench::{Bench, NEVER, fault};
use super::machine::{Group, Machine, Plan};
use super::{ARL_0, TrialError};
use crate::profile::Profile;
use crate::shares::{Share, Spread};
use drivescope_monitor::bank::{AnyProcess, known_process, with_noise};

/// The faults.
pub(super) const FAULTS: [(&str, f64); 8] = [
    ("tacho", 0.05),
    ("flux", 0.05),
    ("actuator", 0.05),
    ("load", 0.05),
    ("tacho", 0.01),
    ("flux", 0.01),
    ("resistance", 0.2),
    ("friction", 0.2),
];
/// Samples of a run after the onset.
pub(super) const AFTER: usize = 800;
/// Healthy samples of each machine for the limits of the known model, and machines.
const KNOWN_SAMPLES: usize = 15_000;
const KNOWN_MACHINES: usize = 60;

/// Delay at one mean time between false alarms.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Delay {
    /// Designed mean samples between false alarms.
    pub arl_0: f64,
    /// Machines on which it was detected within the run.
    pub detected: Share,
    /// Samples from the onset to the alarm: 0 is the first faulty sample.
    pub samples: Spread,
    /// The same of the known model.
    pub known: Spread,
}

/// Delays of one fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DelayRow {
    pub mechanism: String,
    /// Magnitude.
    pub size: f64,
    /// At each mean time between false alarms.
    pub delays: Vec<Delay>,
}

pub(super) fn delays(bench: &Bench) -> Result<Vec<DelayRow>, TrialError> {
    let bank = ARL_0.map(|arl_0| bench.designed.tails.limits(arl_0));
    let row = |(number, (mechanism, size)): (usize, &(&str, f64))| {
        let known = known_limits(bench, mechanism)?;
        let found = bench.each(Group::Delays, bench.machines, |machine, _| {
            machine.renew_noise(number);
            let onset = machine.onset(bench);
            let reference = vec![machine.experiment.set_point; onset + AFTER];
            let size = machine.sign() * size;
            let faults = vec![fault(mechanism, size, onset, Profile::Step)];
            let runs = machine.rows(&[Plan { reference, faults }]);
            let own = known_of(bench, machine, mechanism)?;
            let process = bench.designed.process.as_ref();
            Ok([
                first_over(bench, process, &bank, &runs[0], onset),
                first_over(bench, own.as_ref(), &known, &runs[0], onset),
            ])
        });
        let found = found.into_iter().collect::<Result<Vec<_>, TrialError>>()?;
        let delays = (0..ARL_0.len()).map(|k| {
            let of = |which: usize| {
                let some = found.iter().filter_map(move |both| both[which][k]);
                some.map(|delay| delay as f64).collect::<Vec<f64>>()
            };
            let own = of(0);
            Delay {
                arl_0: ARL_0[k],
                detected: Share::new(own.len(), found.len()),
                samples: Spread::of(own),
                known: Spread::of(of(1)),
            }
        });
        let delays = delays.collect();
        Ok(DelayRow { mechanism: (*mechanism).to_owned(), size: *size, delays })
    };
    FAULTS.iter().enumerate().map(row).collect()
}

/// The process of one machine, known exactly, on which only that mechanism can fail.
fn known_of(
    bench: &Bench,
    machine: &Machine,
    mechanism: &str,
) -> Result<Box<dyn AnyProcess>, TrialError> {
    let others: Vec<&str> =
        MECHANISMS.iter().map(|it| it.id).filter(|id| *id != mechanism).collect();
    let drive = with_noise(&machine.experiment.drive, &bench.designed.noise);
    Ok(known_process(&drive, bench.experiment.period_s, &others)?)
}

/// Limits of the known model, from healthy runs of other machines.
fn known_limits(bench: &Bench, mechanism: &str) -> Result<[Limits; ARL_0.len()], TrialError> {
    let statistics = bench.each(Group::Known, KNOWN_MACHINES, |machine, _| {
        let samples = bench.designed.how.baseline + KNOWN_SAMPLES;
        let reference = vec![machine.experiment.set_point; samples];
        let runs = machine.rows(&[Plan { reference, faults: Vec::new() }]);
        let process = known_of(bench, machine, mechanism)?;
        let watched = bench.watch(process.as_ref(), NEVER, &runs[0]);
        Ok(watched.map_or_else(Vec::new, |(mut watch, rows)| {
            let ratio = |row: &Row| {
                watch.step(row);
                watch.statistics().mechanisms
            };
            rows.iter().map(ratio).collect::<Vec<f64>>()
        }))
    });
    let statistics = statistics.into_iter().collect::<Result<Vec<_>, TrialError>>()?;
    let tail = Tail::of(statistics.into_iter().flatten())?;
    Ok(ARL_0.map(|arl_0| Limits { ratio: tail.limit(arl_0), squares: f64::INFINITY }))
}

/// Samples from the onset until a statistic is over each of some limits; nothing where it never
/// is, or was within the last block before the onset.
pub(super) fn first_over<const L: usize>(
    bench: &Bench,
    process: &dyn AnyProcess,
    limits: &[Limits; L],
    rows: &[Row],
    onset: usize,
) -> [Option<usize>; L] {
    let mut first = [None; L];
    let Some((mut watch, rest)) = bench.watch(process, NEVER, rows) else { return first };
    let mut early = [false; L];
    for (row, at) in rest.iter().zip(bench.designed.how.baseline..) {
        watch.step(row);
        let found = watch.statistics();
        for (k, limits) in limits.iter().enumerate() {
            let alone = limits.squares.is_infinite();
            let ratio = if alone { found.mechanisms } else { found.ratio };
            if ratio > limits.ratio || found.squares > limits.squares {
                if at < onset {
                    early[k] = true;
                } else if !early[k] {
                    first[k].get_or_insert(at - onset);
                }
            }
        }
    }
    first
}
