//! The randomness with which recordings are most probable: each of its numbers in turn is moved to
//! the top of the parabola through three of its values, until none moves any more.

use drivescope_plant::drive::Input;

use super::base::{Known, pooled, probability};
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
/// Gain in ln of the likelihood that a step must promise.
const WORTH: f64 = 0.3;
/// Least and greatest distance of the values of a parabola, ln.
const DISTANCE: (f64, f64) = (0.1, 1.1);
/// Distances that a step goes at most.
const FURTHEST: f64 = 2.5;
/// Distances below which a step leaves the other numbers where they are best.
const SMALL: f64 = 0.5;
/// Turns through the numbers at most.
const TURNS: usize = 8;

/// A number of a randomness.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
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
        let of = |tried: &Self| judge.of_randomness(tried).unwrap_or(f64::NEG_INFINITY);
        let mut best = *self;
        let mut most = judge.of_randomness(self)?;
        let numbers = self.numbers(scene);
        let mut distances = vec![first; numbers.len()];
        let mut settled = vec![false; numbers.len()];
        for place in (0..numbers.len()).cycle().take(TURNS * numbers.len()) {
            if settled[place] {
                if settled.iter().all(|it| *it) {
                    break;
                }
                continue;
            }
            let distance = distances[place];
            let tried = |by: f64| best.moved(numbers[place], by, scene);
            let beside = |by: f64| {
                let tried = tried(by);
                if tried == best { f64::NEG_INFINITY } else { of(&tried) }
            };
            let (up, down) = rayon::join(|| beside(distance), || beside(-distance));
            let (mut by, mut found) = if up > down { (distance, up) } else { (-distance, down) };
            let slope = (up - down) / (2.0 * distance);
            let bend = (2.0 * most - up - down) / (distance * distance);
            if bend > 0.0 && bend.is_finite() {
                let limit = FURTHEST * distance;
                let whole = slope / bend;
                let top = whole.clamp(-limit, limit);
                let promised = most + top * (slope - 0.5 * bend * top);
                if promised > found.max(most) + WORTH {
                    let at_top = of(&tried(top));
                    if at_top > found {
                        (by, found) = (top, at_top);
                    }
                }
                // Where the likelihood falls by one; far from the top the parabola does not tell it.
                if whole == top {
                    distances[place] = (2.0 / bend).sqrt().clamp(DISTANCE.0, DISTANCE.1);
                }
            }
            settled[place] = true;
            if found > most + WORTH {
                best = tried(by);
                most = found;
                if by.abs() > SMALL * distances[place] {
                    settled.fill(false);
                    settled[place] = bend > 0.0 && by.abs() < distance;
                }
            }
        }
        Some(best)
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

    /// With one of its numbers moved, ln.
    fn moved(mut self, number: Number, by: f64, scene: &Scene) -> Self {
        let factor = by.exp();
        match number {
            Number::LoadSize => self.load_sd *= factor,
            Number::LoadTime => {
                let period_s = slowest(scene);
                let longest_s = LONGEST_S.max(4.0 * period_s);
                // What the load does within a few samples is told best: it stays.
                let time_s = (factor * self.load_s).clamp(SHORTEST * period_s, longest_s);
                self = self.with_time(time_s);
            }
            Number::VoltageSize => self.voltage_sd *= factor,
            Number::Sensor(sensor) => self.sensors[sensor] *= factor,
            Number::Cycle(field) => self.cycle = self.cycle.map(|it| it.moved(field, factor)),
        }
        self
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

    /// Tracks of the recordings as the plant was linearised.
    pub(super) fn tracks(&self) -> &[Track] {
        &self.along
    }
}
