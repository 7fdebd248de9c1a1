//! The search for the randomness with which recordings are most probable: which of its numbers they tell,
//! and how far each may move.

use drivescope_plant::drive::Input;

use super::base::{Known, pooled, probability};
use super::climb::Climb;
use super::gram::References;
use super::guess::slowest;
use super::randomness::Randomness;
use super::scene::{Recorded, Scene};
use super::state::SENSORS;
use super::track::Track;
use crate::measured::Output;

/// Longest correlation time of a random load, s: what stays the same for longer is a load.
const LONGEST_S: f64 = 1.0;
/// Shortest one over the sampling time.
const SHORTEST: f64 = 2.0;
/// First change of each number, ln: the randomness is not known, or it is nearly.
pub(super) const COARSE: f64 = 1.1;
pub(super) const FINE: f64 = 0.6;
/// Turns through the numbers one by one where nothing is known, and steps of all of them at most.
const TURNS: usize = 2;
const STEPS: usize = 4;

/// A number of a randomness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    LoadSize,
    LoadTime,
    VoltageSize,
    Sensor(usize),
    /// A field of the cycle, in their order.
    Cycle(usize),
}

/// Share of the voltage's first guess with which a search begins that is to find a load.
const QUIET: f64 = 0.02;

impl Randomness {
    /// As [`Self::searched`] where nothing is known yet: with no current, a random voltage passes for
    /// a load, and leaves out what is slow of it: the search begins with little voltage too.
    pub(super) fn sought(
        &self,
        scene: &Scene,
        references: &References,
        first: f64,
    ) -> Option<Self> {
        let found = self.searched(scene, references, first)?;
        let has_current = |it: &Recorded| it.measured.output(Output::Current).is_some();
        let force = scene.drive.motor.input == Input::Force;
        if force || scene.recordings.iter().all(has_current) {
            return Some(found);
        }
        let quiet = Self { voltage_sd: QUIET * self.voltage_sd, ..*self };
        let Some(other) = quiet.searched(scene, references, first) else { return Some(found) };
        let judge = Judge::of(scene, references, &found)?;
        let worth = |it: &Self| judge.of_randomness(it).unwrap_or(f64::NEG_INFINITY);
        Some(if worth(&other) > worth(&found) { other } else { found })
    }

    /// Found by a search that begins here with changes of that size, ln, the plant linearised as it
    /// is here.
    pub(super) fn searched(
        &self,
        scene: &Scene,
        references: &References,
        first: f64,
    ) -> Option<Self> {
        let judge = Judge::of(scene, references, self)?;
        let mut climb = Climb::from(*self, &judge, self.numbers(scene), first)?;
        if first > FINE {
            (0..TURNS).all(|_| climb.one_by_one());
        }
        (0..STEPS).all(|_| climb.together());
        Some(climb.best)
    }

    /// Its numbers that the recordings may tell.
    fn numbers(&self, scene: &Scene) -> Vec<Number> {
        let has = |output| scene.recordings.iter().any(|it| it.measured.output(output).is_some());
        let outputs = [Output::Current, Output::Speed, Output::Position];
        let mut numbers = vec![Number::LoadSize, Number::LoadTime];
        if scene.drive.motor.input == Input::Voltage {
            numbers.push(Number::VoltageSize);
        }
        if self.cycle.is_some() {
            numbers.extend((0..3).map(Number::Cycle));
        }
        numbers.extend((0..SENSORS).filter(|it| has(outputs[*it])).map(Number::Sensor));
        numbers
    }
}

/// Evidence of what is random, the plant linearised once.
pub(super) struct Judge<'a> {
    scene: &'a Scene,
    references: &'a References,
    along: Vec<Track>,
    known: Vec<Known>,
}

impl<'a> Judge<'a> {
    /// Linearised with that randomness; nothing where the drive overflows.
    pub(super) fn of(
        scene: &'a Scene,
        references: &'a References,
        randomness: &Randomness,
    ) -> Option<Self> {
        let along = scene.tracks(randomness)?;
        let known = Known::of(scene, &along);
        Some(Self { scene, references, along, known })
    }

    /// ln of the probability of the recordings with that randomness.
    pub(super) fn of_randomness(&self, tried: &Randomness) -> Option<f64> {
        let tracks = self.scene.retraced(&self.along, tried)?;
        let pooled = pooled(self.scene, &tracks, self.references, Some(&self.known));
        Some(probability(self.scene, &tracks, &pooled, true))
    }

    /// That randomness with one of its numbers moved, ln.
    pub(super) fn moved(&self, mut it: Randomness, number: Number, by: f64) -> Randomness {
        let factor = by.exp();
        match number {
            Number::LoadSize => it.load_sd *= factor,
            Number::LoadTime => {
                let period_s = slowest(self.scene);
                let longest_s = LONGEST_S.max(4.0 * period_s);
                // What the load does within a few samples is told best: it stays.
                let time_s = (factor * it.load_s).clamp(SHORTEST * period_s, longest_s);
                it = it.with_time(time_s);
            }
            Number::VoltageSize => it.voltage_sd *= factor,
            Number::Sensor(sensor) => it.sensors[sensor] *= factor,
            Number::Cycle(field) => it.cycle = it.cycle.map(|it| it.moved(field, factor)),
        }
        it
    }

    /// Tracks of the recordings as the plant was linearised.
    pub(super) fn tracks(&self) -> &[Track] {
        &self.along
    }
}
