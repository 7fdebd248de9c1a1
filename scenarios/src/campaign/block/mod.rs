//! Scenarios side by side: drives, noise and detectors as lanes of one block.
//!
//! A lane gives the same bits whatever stands beside it: every block has the sub-steps of the
//! plan's nominal drive, halved, and a scenario that needs shorter ones, or another controller or
//! sensor than the nominal one, runs alone.

mod foreign;
mod ready;
mod recorder;
mod tally;
mod timeline;
mod watch;

use drivescope_plant::drive::Drive;
use drivescope_plant::fault::{FaultLanes, Faults};
use drivescope_plant::integrate::{Block, Integrator, Stepper, longest_substep};
use drivescope_plant::model::Model;
use drivescope_plant::parameters::Role;
use drivescope_plant::sampled::{InputLanes, Inputs, Sampled, Samples, Span, speed_bound};
use drivescope_recording::Recording;

use super::bank::Bank;
use super::design::Design;
use super::noise::{Channels, LaneNoise, NoiseLanes};
use super::plan::{Plan, stream_of_noise};
use crate::cosimulated::RunError;
use ready::Ready;
use recorder::Recorder;
pub(super) use tally::Found;
pub(super) use watch::Outcome;
use watch::{Watch, Watched};

/// Scenarios side by side: two vectors of AVX-512, four of AVX2.
pub(super) const LANES: usize = 16;
/// Sub-steps of a block over those of the nominal drive: machines differ.
const MARGIN: f64 = 0.5;

/// What all blocks of a plan share.
pub(super) struct Blocks<'a> {
    plan: &'a Plan,
    design: &'a Design,
    /// The bank, if the plan has one.
    bank: Option<Bank<'a>>,
    /// The nominal drive, its K_m a parameter of its own.
    drive: Drive,
    /// Names and values of its parameters.
    nominal: Vec<(String, f64)>,
    /// Where the plan's parameters stand among them.
    places: Vec<usize>,
    /// Longest sub-step of a block, s, and the greatest speed.
    longest: f64,
    speed: f64,
    channels: Channels,
    /// Delay of the nominal drive, s, if it has one.
    delays: Option<[f64; 1]>,
    /// Whether the plan changes numbers outside the balances.
    beside: bool,
}

impl<'a> Blocks<'a> {
    pub(super) fn new(plan: &'a Plan, design: &'a Design) -> Self {
        let mut drive = plan.experiment.drive.clone();
        // A run takes the file's own K_m, tied in fits or not.
        drive.motor.tie_k = false;
        let all = drive.parameters();
        let name = |place: &usize| all[*place].name.as_str();
        let places = plan
            .parameters()
            .filter_map(|parameter| (0..all.len()).find(|place| name(place) == parameter.name));
        let beside = plan.parameters().any(|parameter| parameter.role != Role::Physics);
        let noisy = plan.parameters().any(|parameter| parameter.role == Role::Sensing);
        let (speed, model) = (speed_bound(&drive), drive.model());
        Self {
            places: places.collect(),
            nominal: all.iter().map(|it| (it.name.clone(), it.value)).collect(),
            longest: MARGIN * longest_substep(&model, speed),
            delays: model.delays(),
            channels: if noisy { Channels::ALL } else { Channels::of(&drive.noise) },
            bank: design.bank.as_ref().and_then(|bank| Bank::new(plan, bank)),
            plan,
            design,
            drive,
            speed,
            beside,
        }
    }

    /// Runs scenarios, in their order: what became of each, or why there is no result.
    pub(super) fn run(&self, scenarios: &[Ready]) -> Vec<Result<Outcome, String>> {
        if let Some(plant) = &self.plan.foreign {
            let one = |ready| self.of_foreign(plant, ready).transpose();
            let made = scenarios.iter().filter_map(one);
            return made.map(|made| made.map_err(|error| error.to_string())).collect();
        }
        let mut made: Vec<Option<Outcome>> = vec![None; scenarios.len()];
        let together: Vec<usize> =
            (0..scenarios.len()).filter(|k| scenarios[*k].alone.is_none()).collect();
        for some in together.chunks(LANES) {
            let last = some[some.len() - 1];
            let lanes: [&Ready; LANES] =
                std::array::from_fn(|l| &scenarios[*some.get(l).unwrap_or(&last)]);
            let models = lanes.map(|ready| &ready.model);
            let block = Block::paced(Model::side_by_side(models), self.longest);
            let sampled = Sampled::new(&self.drive, block, true);
            let outcomes = self.lanes((lanes, some.len()), sampled);
            for (k, outcome) in some.iter().zip(outcomes) {
                made[*k] = outcome;
            }
        }
        for (ready, made) in scenarios.iter().zip(&mut made) {
            if let Some(longest) = ready.alone {
                let integrator = Integrator::paced(ready.model.clone(), longest);
                let drive = ready.drive.as_ref().unwrap_or(&self.drive);
                let sampled = Sampled::new(drive, integrator, true);
                let [outcome] = self.lanes(([ready], 1), sampled);
                *made = outcome;
            }
        }
        made.into_iter().flatten().map(Ok).collect()
    }

    /// The signals of a scenario.
    ///
    /// # Errors
    /// A foreign FMU gave none.
    pub(super) fn trace(&self, ready: &Ready) -> Result<Recording, RunError> {
        if let Some(plant) = &self.plan.foreign {
            return self.foreign_trace(plant, ready);
        }
        let longest = ready.alone.unwrap_or(self.longest);
        let integrator = Integrator::paced(ready.model.clone(), longest);
        let drive = ready.drive.as_ref().unwrap_or(&self.drive);
        let mut recorder = Recorder::new(self.noise([ready]), self.inputs([ready]));
        self.through([ready], &mut Sampled::new(drive, integrator, true), &mut recorder);
        Ok(recorder.recording(self.plan, ready.scenario.index))
    }

    /// Runs drives side by side, of which the first `count` are asked for.
    fn lanes<const N: usize, S: Stepper<N>>(
        &self,
        (lanes, count): ([&Ready; N], usize),
        mut sampled: Sampled<N, S>,
    ) -> [Option<Outcome>; N] {
        let Some(mut watch) = self.watch(lanes, count) else {
            return std::array::from_fn(|_| None);
        };
        self.through(lanes, &mut sampled, &mut watch);
        std::array::from_fn(|l| Some(watch.outcome(l, self.plan)))
    }

    /// Detectors over scenarios side by side, of which the first `count` are asked for.
    fn watch<const N: usize>(&self, lanes: [&Ready; N], count: usize) -> Option<Watch<'_, N>> {
        let watched = lanes.map(|ready| {
            let (from, until) = ready.scenario.faulty().unwrap_or((usize::MAX, usize::MAX));
            Watched { settings: ready.scenario.settings, from: from as u64, until: until as u64 }
        });
        let (inputs, noise) = (self.inputs(lanes), self.noise(lanes));
        let asked = watched[..count].iter().map(|it| (it.settings, (it.from, it.until)));
        let bank = self.bank.as_ref().map(|bank| bank.lanes(asked));
        Watch::new((self.plan, self.design), watched, (inputs, noise), bank)
    }

    /// What enters the drives and stays.
    fn inputs<const N: usize>(&self, lanes: [&Ready; N]) -> InputLanes<f64, N> {
        let mut inputs = InputLanes::splat(Inputs::NONE);
        inputs.reference = lanes.map(|ready| ready.scenario.set_point);
        inputs
    }

    fn noise<const N: usize>(&self, lanes: [&Ready; N]) -> NoiseLanes<N> {
        let noise = lanes.map(|ready| LaneNoise {
            seed: stream_of_noise(self.plan.seed, &ready.scenario),
            deviations: ready.drive.as_ref().map_or(self.drive.noise, |drive| drive.noise),
        });
        let per_si = self.drive.sensors.tacho_unit.per_si();
        NoiseLanes::new(noise, self.channels, self.plan.experiment.period_s, per_si)
    }

    /// Runs the drives from rest to the end, their faults as they come.
    fn through<const N: usize, S: Stepper<N>>(
        &self,
        lanes: [&Ready; N],
        sampled: &mut Sampled<N, S>,
        samples: &mut impl Samples<N>,
    ) {
        let (end_of_run, period_s) = (self.plan.samples, self.plan.experiment.period_s);
        let mut changes: Vec<(usize, usize, &Faults<f64>)> = Vec::new();
        for (l, ready) in lanes.iter().enumerate() {
            changes.extend(ready.timeline.iter().map(|(at, faults)| (*at, l, faults)));
        }
        changes.sort_by_key(|(at, l, _)| (*at, *l));
        let mut faults = FaultLanes::splat(Faults::NONE);
        let (mut changes, mut start) = (changes.into_iter().peekable(), 0);
        while start < end_of_run {
            while let Some((_, l, now)) = changes.next_if(|(at, ..)| *at <= start) {
                faults.set_lane(l, *now);
            }
            let end = changes.peek().map_or(end_of_run, |(at, ..)| *at);
            let span = Span { start_s: 0.0, period_s, samples: start..end };
            sampled.run(&span, &faults, samples);
            start = end;
        }
    }
}
