//! The test bench: machines of one kind, and the bank that watches them.

use drivescope_diagnoser::bank::{Cause, Event, Judgement, Limits, Row, Tails};
use drivescope_plant::drive::Drive;
use rand::RngExt;
use rayon::prelude::*;

use super::course::Course;
use super::machine::{Group, Machine, Plan, machine};
use super::{TrialError, TrialOptions};
use crate::experiment::Experiment;
use crate::faults::Fault;
use crate::profile::Profile;
use crate::results::FaultName;
use drivescope_monitor::bank::{AnyProcess, AnyWatch, Designed, design, without_current};

/// Healthy runs of the design, and samples of each.
const DESIGN_RUNS: u64 = 2;
const DESIGN_SAMPLES: usize = 4000;
/// Healthy samples between a baseline and a fault, at least, and at most so many more.
pub(super) const HEALTHY_BEFORE: usize = 100;
const SOME_MORE: usize = 100;
/// Limits that nothing reaches.
pub(super) const NEVER: Limits = Limits { ratio: f64::INFINITY, squares: f64::INFINITY };

/// The bank and how machines are drawn.
pub(super) struct Bench {
    pub(super) experiment: Experiment,
    pub(super) designed: Designed,
    pub(super) machines: usize,
    pub(super) arl_0: f64,
    pub(super) judged_seed: u64,
}

/// What a watch found about a fault.
pub(super) struct Seen {
    /// Sample of the first alarm from the onset on.
    pub(super) alarm: Option<usize>,
    /// The first judgement from then on that is not "healthy".
    pub(super) judgement: Option<Judgement>,
}

impl Bench {
    pub(super) fn new(drive: Drive, options: &TrialOptions) -> Result<Self, TrialError> {
        let experiment = Experiment::new(drive.clone(), options.seed)?;
        let shown = |_: &mut Machine| vec![experiment.set_point; DESIGN_SAMPLES];
        Self::designed_on(&experiment, &drive, options, shown)
    }

    /// The bank of a model that need not be the machine's, designed on the machine along a course.
    pub(super) fn with_model(
        machine: Drive,
        model: &Drive,
        options: &TrialOptions,
        course: Course,
    ) -> Result<Self, TrialError> {
        let experiment = Experiment::new(machine, options.seed)?;
        let along = |machine: &mut Machine| {
            let mut made = course.speeds(experiment.set_point, DESIGN_SAMPLES / 4, machine);
            made.truncate(DESIGN_SAMPLES);
            made
        };
        Self::designed_on(&experiment, model, options, along)
    }

    fn designed_on(
        experiment: &Experiment,
        model: &Drive,
        options: &TrialOptions,
        reference: impl Fn(&mut Machine) -> Vec<f64>,
    ) -> Result<Self, TrialError> {
        let runs = (0..DESIGN_RUNS).flat_map(|number| {
            let mut machine = machine(experiment, Group::Design, number);
            let reference = reference(&mut machine);
            machine.rows(&[Plan { reference, faults: Vec::new() }])
        });
        let runs: Vec<Vec<Row>> = runs.collect();
        let designed = design(model, experiment.period_s, &runs, options.seed)?;
        let judged_seed = options.seed.wrapping_add(1);
        let experiment = experiment.with_seed(judged_seed);
        let TrialOptions { machines, arl_0, .. } = *options;
        Ok(Self { experiment, designed, machines, arl_0, judged_seed })
    }

    /// A machine of that number, for that purpose.
    pub(super) fn machine(&self, group: Group, number: usize) -> Machine {
        machine(&self.experiment, group, number as u64)
    }

    /// The tails of the statistics with the current or without.
    pub(super) fn tails(&self, with_current: bool) -> Tails {
        let blind = self.designed.tails_without_current.filter(|_| !with_current);
        blind.unwrap_or(self.designed.tails)
    }

    /// The limits at the designed time between false alarms, with the current or without.
    pub(super) fn limits(&self, with_current: bool) -> Limits {
        self.tails(with_current).limits(self.arl_0)
    }

    /// A watch that learned the machine from its first rows, and the rows after them; nothing if
    /// the rows are refused.
    pub(super) fn watch<'a>(
        &self,
        process: &dyn AnyProcess,
        limits: Limits,
        rows: &'a [Row],
    ) -> Option<(Box<dyn AnyWatch>, &'a [Row])> {
        let (baseline, rest) = rows.split_at(self.designed.how.baseline);
        Some((process.learn(baseline, limits, self.designed.how.horizon).ok()?, rest))
    }

    /// What a bank finds about what begins at sample `onset` of a run.
    pub(super) fn seen(
        &self,
        process: &dyn AnyProcess,
        limits: Limits,
        rows: &[Row],
        onset: usize,
    ) -> Seen {
        let mut seen = Seen { alarm: None, judgement: None };
        let Some((mut watch, rest)) = self.watch(process, limits, rows) else { return seen };
        for (row, at) in rest.iter().zip(self.designed.how.baseline..) {
            let Some(event) = watch.step(row) else { continue };
            if at < onset {
                continue;
            }
            match event {
                Event::Alarm(_) => {
                    seen.alarm.get_or_insert(at);
                }
                Event::Judged(judgement) if judgement.cause != Cause::Healthy => {
                    seen.judgement = Some(judgement);
                    break;
                }
                Event::Judged(_) | Event::Ended(_) => {}
            }
        }
        seen
    }

    /// Works on all machines of a group, in parallel; in their order.
    pub(super) fn each<R: Send>(
        &self,
        group: Group,
        machines: usize,
        of: impl Fn(&mut Machine, usize) -> R + Sync,
    ) -> Vec<R> {
        let numbers = (0..machines).into_par_iter();
        numbers.map(|number| of(&mut self.machine(group, number), number)).collect()
    }
}

impl Machine {
    /// An onset some time after the baseline.
    pub(super) fn onset(&mut self, bench: &Bench) -> usize {
        bench.designed.how.baseline + HEALTHY_BEFORE + self.random.random_range(0..SOME_MORE)
    }
}

impl Course {
    /// Speeds of a baseline at the set point that was shown, and of the course after it.
    pub(super) fn reference(self, bench: &Bench, machine: &mut Machine) -> Vec<f64> {
        self.speeds(machine.experiment.set_point, bench.designed.how.baseline, machine)
    }
}

/// The printed set, the named mechanism first; empty where none is named.
pub(super) fn set(process: &dyn AnyProcess, judgement: &Judgement) -> Vec<String> {
    let Cause::Mechanism(_) = judgement.cause else { return Vec::new() };
    judgement
        .confusion_set()
        .iter()
        .map(|it| process.mechanisms()[it.mechanism].id.clone())
        .collect()
}

/// A fault from that sample on.
pub(super) fn fault(kind: &str, size: f64, from: usize, profile: Profile) -> Fault {
    let name = FaultName { kind: kind.to_owned(), size, label: String::new() };
    Fault { name, from, until: usize::MAX, profile }
}

/// The rows with the current or without.
pub(super) fn with_or_without(rows: &[Row], with_current: bool) -> Vec<Row> {
    if with_current { rows.to_vec() } else { without_current(rows) }
}
