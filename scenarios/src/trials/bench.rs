//! The test bench: machines of one kind, what they show, and the bank that watches them.

use drivescope_diagnoser::bank::{Cause, Event, Judgement, Limits, Row, Tails};
use drivescope_plant::drive::Drive;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::healthy::Course;
use super::{TrialError, TrialOptions};
use crate::experiment::{Experiment, Stream};
use crate::faults::Fault;
use crate::native::ClosedLoops;
use crate::profile::Profile;
use crate::results::FaultName;
use drivescope_monitor::bank::{AnyProcess, AnyWatch, Designed, design, without_current};

/// Standard deviations over machines of one kind, as fractions.
const RESISTANCE: f64 = 0.03;
const FRICTION: f64 = 0.10;
/// Torques of dry friction, by effect: they share a factor with the viscous one.
const DRY: [(&str, &str); 2] = [("coulomb", "T_c"), ("stribeck", "T_b")];
/// Healthy runs of the design, and samples of each.
const DESIGN_RUNS: u64 = 2;
const DESIGN_SAMPLES: usize = 4000;
/// Healthy samples between a baseline and a fault, at least, and at most so many more.
pub(super) const HEALTHY_BEFORE: usize = 100;
const SOME_MORE: usize = 100;
/// Closed loops side by side.
const LANES: usize = 16;
/// Limits that nothing reaches.
pub(super) const NEVER: Limits = Limits { ratio: f64::INFINITY, squares: f64::INFINITY };

/// What is tried, for seeds that do not meet.
#[derive(Debug, Clone, Copy)]
pub(super) enum Group {
    Design,
    Classes,
    Mechanisms,
    Delays,
    Known,
    Incipient,
    Unknown,
    Healthy,
    Curves,
    Hidden,
}

/// The bank and how machines are drawn.
pub(super) struct Bench {
    pub(super) experiment: Experiment,
    pub(super) designed: Designed,
    pub(super) machines: usize,
    pub(super) arl_0: f64,
    pub(super) judged_seed: u64,
}

/// A machine, with noise of its own.
pub(super) struct Machine {
    pub(super) experiment: Experiment,
    pub(super) random: Pcg64Mcg,
}

/// A run of a machine.
pub(super) struct Plan {
    /// Speed that it follows, rad/s, one value a sample.
    pub(super) reference: Vec<f64>,
    pub(super) faults: Vec<Fault>,
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

fn machine(experiment: &Experiment, group: Group, number: u64) -> Machine {
    /// Spreads neighbouring seeds and numbers: 2^64 over the golden ratio, odd.
    const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;
    let seed = experiment.seed.wrapping_mul(SPREAD).rotate_left(23)
        ^ ((group as u64) << 40 | number).wrapping_mul(SPREAD);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut factor = |sd: f64| {
        let normal: f64 = StandardNormal.sample(&mut random);
        1.0 + sd * normal
    };
    let mut drive = experiment.drive.clone();
    drive.motor.r = drive.motor.r.map(|r| r * factor(RESISTANCE));
    let friction = factor(FRICTION);
    drive.motor.b_m *= friction;
    for effect in &mut drive.effects {
        let dry = |name: &str| DRY.contains(&(effect.kind.as_str(), name));
        let torques = effect.parameters.iter_mut().filter(|(name, _)| dry(name));
        torques.for_each(|(_, torque)| *torque *= friction);
    }
    Machine { experiment: experiment.with_drive(drive).with_seed(seed), random }
}

impl Machine {
    /// From now on with the noise of that number: each thing that is tried on a machine has its own.
    pub(super) fn renew_noise(&mut self, number: usize) {
        self.experiment = self.experiment.with_seed(self.experiment.seed ^ number as u64);
    }

    /// What the sensors show over those runs, which have one length.
    pub(super) fn rows(&self, plans: &[Plan]) -> Vec<Vec<Row>> {
        let mut loops = ClosedLoops::<LANES>::new(&self.experiment.drive);
        let per_si = self.experiment.drive.sensors.tacho_unit.per_si();
        let mut made = Vec::with_capacity(plans.len());
        for (some, first) in plans.chunks(LANES).zip((0..).step_by(LANES)) {
            let inputs = some.iter().zip(first..).map(|(plan, number)| {
                let stream = Stream::Faulty(number);
                self.experiment.following(plan.reference.clone(), stream, &plan.faults)
            });
            let inputs: Vec<_> = inputs.collect();
            made.extend(loops.run(&inputs).iter().map(|run| {
                let [c_m, t, i_m] = [0, 1, 2].map(|signal| &run.signals[signal].values);
                let row =
                    |k: usize| Row { control: c_m[k], shown: [t[k] / per_si, i_m[k], f64::NAN] };
                (0..run.len()).map(row).collect::<Vec<_>>()
            }));
        }
        made
    }

    /// An onset some time after the baseline.
    pub(super) fn onset(&mut self, bench: &Bench) -> usize {
        bench.designed.how.baseline + HEALTHY_BEFORE + self.random.random_range(0..SOME_MORE)
    }

    /// Plus or minus one.
    pub(super) fn sign(&mut self) -> f64 {
        if self.random.random() { 1.0 } else { -1.0 }
    }
}

/// The printed set, the named mechanism first; empty where none is named.
pub(super) fn set(process: &dyn AnyProcess, judgement: &Judgement) -> Vec<String> {
    let Cause::Mechanism(_) = judgement.cause else { return Vec::new() };
    let confused = &judgement.candidates[..judgement.confused.max(1)];
    confused.iter().map(|it| process.mechanisms()[it.mechanism].id.clone()).collect()
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
