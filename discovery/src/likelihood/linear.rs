//! What the model predicts of a sample, and its derivative: from the plant itself, or as the plant
//! was linearised along a track.

use std::sync::Arc;

use drivescope_numerics::Dual;
use drivescope_plant::drive::Drive;
use drivescope_plant::effects::law::Variable;
use drivescope_plant::effects::registry::Entry;
use drivescope_plant::model::SPEED;

use super::direction::Direction;
use super::exponential::Exponential;
use super::plant::Plant;
use super::rows::{NO_ROWS, Rows, Upper, add, product, times};
use super::state::{LOAD, SENSORS, STATES, Vector, own_states};
use super::track::{Step, Tick, Track};
use crate::measured::Measured;

/// Parts of a sample in which teeth may meet, and parts of the armature's time constant.
const KNOCKING: usize = 8;
const SETTLING: f64 = 6.0;

type Number = Dual<STATES>;

/// What a filter asks of the plant.
pub(super) trait Linearised {
    /// A piece begins.
    fn begin(&mut self);
    /// What the sensors show of the predicted state; returns the derivatives.
    fn shown(&mut self, tick: &mut Tick) -> &[Vector; SENSORS];
    /// The filtered state one sample later, disturbances left out; returns the derivatives.
    fn propagate(&mut self, tick: &mut Tick) -> &Step;
    /// What a torque does to the state over a sample in which the shaft slips, over what it does to
    /// the speed.
    fn slipping(&mut self, sample: usize) -> Vector;
    /// The derivatives along the whole track.
    fn steps(self) -> Arc<Vec<Step>>;
}

/// The plant itself, its rates linear over a part of a sample.
pub(super) struct Itself<'a> {
    plant: Plant<'a, STATES>,
    direction: &'a Direction,
    exponential: Exponential,
    /// Parts of a sample, and how long each is, s.
    parts: usize,
    part_s: f64,
    /// Derivatives of this sample, and those that differ from those of the sample before.
    transition: Rows,
    input: Rows,
    sense: [Vector; SENSORS],
    steps: Vec<Step>,
    last: Option<(Rows, Rows, [Vector; SENSORS])>,
}

impl<'a> Itself<'a> {
    pub(super) fn new(drive: &Drive, measured: &'a Measured, direction: &'a Direction) -> Self {
        let constant = |_: &str, value: f64| Number { v: value, d: [0.0; STATES] };
        let parts = parts(drive, measured.period_s);
        Self {
            plant: Plant::new(drive, measured, own_states(drive), constant),
            direction,
            exponential: Exponential::new(),
            parts,
            part_s: measured.period_s / parts as f64,
            transition: NO_ROWS,
            input: NO_ROWS,
            sense: [Vector::zeros(); SENSORS],
            steps: Vec::new(),
            last: None,
        }
    }
}

impl Linearised for Itself<'_> {
    fn begin(&mut self) {
        self.plant.begin();
    }

    fn shown(&mut self, tick: &mut Tick) -> &[Vector; SENSORS] {
        self.plant.enter(tick.sample);
        let shown = self.plant.shown(&tick.predicted, Number::parameter);
        tick.shown = shown.map(|it| it.v);
        self.sense = shown.map(|it| Vector::from(it.d));
        &self.sense
    }

    fn propagate(&mut self, tick: &mut Tick) -> &Step {
        tick.propagated = tick.filtered;
        let direction = self.direction.at(tick.sample);
        tick.mean = Vector::zeros();
        for part in 0..self.parts {
            self.plant.rates(&tick.propagated, direction, Number::parameter);
            let mut f = Vector::zeros();
            for (row, [rate]) in self.plant.rate.iter().enumerate().take(self.plant.imposed) {
                f[row] = rate.v;
            }
            self.exponential.set(&self.plant.rate_rows(), self.part_s);
            let Exponential { whole, input, mean, .. } = &self.exponential;
            tick.mean += (tick.propagated + times(mean, &f)) / self.parts as f64;
            tick.propagated += times(input, &f);
            (self.transition, self.input) = if part == 0 {
                (*whole, *input)
            } else {
                let mut moved = product(whole, &self.input);
                for (moved, input) in moved.iter_mut().zip(input) {
                    add(moved, 1.0, input);
                }
                (product(whole, &self.transition), moved)
            };
        }
        self.plant.advance();
        let now = (self.transition, self.input, self.sense);
        if self.last.as_ref() != Some(&now) {
            self.steps.push(Step {
                transition: Upper::of(&now.0, self.plant.imposed),
                input: Upper::of(&now.1, self.plant.imposed),
                sense: self.sense,
            });
            self.last = Some(now);
        }
        tick.step = self.steps.len() - 1;
        &self.steps[tick.step]
    }

    fn slipping(&mut self, sample: usize) -> Vector {
        self.plant.enter(sample);
        self.plant.rates(&Vector::zeros(), 1.0, Number::parameter);
        self.exponential.set(&self.plant.rate_rows(), self.part_s);
        let whole = &self.exponential.whole;
        let mut moved = Vector::zeros();
        for state in 0..self.plant.imposed {
            moved[state] = whole[state][LOAD] / whole[SPEED][LOAD];
        }
        if moved.iter().all(|it| it.is_finite()) { moved } else { Vector::zeros() }
    }

    fn steps(self) -> Arc<Vec<Step>> {
        Arc::new(self.steps)
    }
}

/// Parts of a sample over each of which the drive is nearly linear. Within a sample it is mostly the
/// current that moves far.
fn parts(drive: &Drive, period_s: f64) -> usize {
    let infos = || drive.effects.iter().filter_map(|it| Entry::find(&it.kind)).map(|it| it.info);
    if infos().any(|info| info.knocks) {
        return KNOCKING;
    }
    let current = drive.effects.iter().any(|it| it.fails_over().contains(&Variable::Current));
    let armature = match (drive.motor.r, drive.motor.l) {
        (Some(r), Some(l)) if current || infos().any(|info| info.stiff) => period_s * r / l,
        _ => 0.0,
    };
    (SETTLING * armature).ceil().clamp(1.0, KNOCKING as f64) as usize
}

/// The plant as it was linearised along a track.
pub(super) struct Along<'a> {
    track: &'a Track,
    next: usize,
}

impl<'a> Along<'a> {
    pub(super) fn new(track: &'a Track) -> Self {
        Self { track, next: 0 }
    }

    fn now(&self) -> (&'a Tick, &'a Step) {
        let tick = &self.track.ticks[self.next];
        (tick, self.track.step(tick))
    }
}

impl Linearised for Along<'_> {
    fn begin(&mut self) {}

    fn shown(&mut self, tick: &mut Tick) -> &[Vector; SENSORS] {
        let (now, step) = self.now();
        let apart = tick.predicted - now.predicted;
        tick.shown =
            std::array::from_fn(|sensor| now.shown[sensor] + step.sense[sensor].dot(&apart));
        &step.sense
    }

    fn propagate(&mut self, tick: &mut Tick) -> &Step {
        let (now, step) = self.now();
        self.next += 1;
        let apart = tick.filtered - now.filtered;
        tick.propagated = now.propagated + step.transition.times(&apart);
        tick.mean = now.mean + 0.5 * (apart + tick.propagated - now.propagated);
        tick.step = now.step;
        step
    }

    fn slipping(&mut self, _: usize) -> Vector {
        self.track.slipping
    }

    fn steps(self) -> Arc<Vec<Step>> {
        self.track.steps.clone()
    }
}
