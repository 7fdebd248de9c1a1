//! How probable recordings are with a randomness, and the numbers of which it is made.

use super::base::{Known, pooled, probability};
use super::gram::References;
use super::guess::slowest;
use super::randomness::Randomness;
use super::scene::Scene;
use super::track::Track;

/// Longest correlation time of a random load, s: what stays the same for longer is a load.
const LONGEST_S: f64 = 1.0;
/// Shortest one over the sampling time.
const SHORTEST: f64 = 2.0;
/// First change of each number, ln: the randomness is not known, or it is nearly.
pub(super) const COARSE: f64 = 1.1;
pub(super) const FINE: f64 = 0.6;

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
