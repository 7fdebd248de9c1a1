//! How random the load, the voltage and the sensors are: what makes the recordings most probable.

use super::base::{Known, pooled, probability};
use super::filter::{SENSORS, Track};
use super::gram::References;
use super::noise::{Cycle, Noise};
use super::scene::{Scene, rms};
use crate::measured::Output;
use drivescope_plant::drive::Input;

/// Longest correlation time of a random load, s: what stays the same for longer is a load.
const LONGEST_S: f64 = 1.0;
/// Shortest one over the sampling time.
const SHORTEST: f64 = 2.0;
/// Correlation time of the random voltage, s.
const VOLTAGE_S: f64 = 0.02;
/// First factor of a search beside the base, where its randomness is nearly known.
pub(super) const FINE: f64 = 1.8;
/// Gain in ln of the likelihood that a step of the search must bring.
const WORTH: f64 = 0.5;

/// Samples that tell how random a recording is.
const ENOUGH: usize = 4000;

/// Two disturbances, and factors on what is known of the sensors' noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Randomness {
    /// Standard deviation of the load over the inertia, rad/s^2 (m/s^2), and its correlation time,
    /// s. So a fit that moves the inertia does not move what is random.
    pub(crate) load_sd: f64,
    pub(crate) load_s: f64,
    /// Standard deviation of the voltage over the inductance, A/s.
    pub(crate) voltage_sd: f64,
    /// What oscillates of the load.
    pub(crate) cycle: Option<Cycle>,
    /// Factor on each sensor's noise.
    pub(crate) sensors: [f64; SENSORS],
}

impl Randomness {
    /// In a recording whose sensors have that noise.
    pub(crate) fn at(&self, noise: &[f64; SENSORS]) -> Noise {
        Noise {
            load_sd: self.load_sd,
            load_s: self.load_s,
            voltage_sd: self.voltage_sd,
            voltage_s: VOLTAGE_S,
            cycle: self.cycle,
            sensors: std::array::from_fn(|sensor| self.sensors[sensor] * noise[sensor]),
        }
    }

    /// With a load of another size.
    pub(crate) fn scaled(&self, load: f64) -> Self {
        let cycle = self.cycle.map(|it| Cycle { sd: load * it.sd, ..it });
        Self { load_sd: load * self.load_sd, cycle, ..*self }
    }

    /// With a load that forgets what it was after another time, s, and does the same within a few
    /// samples.
    pub(crate) fn with_time(&self, load_s: f64) -> Self {
        Self { load_s, load_sd: self.load_sd * (load_s / self.load_s).sqrt(), ..*self }
    }

    /// A first guess, from what drives.
    pub(super) fn guess(scene: &Scene) -> Self {
        let u = rms(scene.recordings.iter().flat_map(|it| it.measured.u.iter().copied()));
        let current = match scene.drive.motor.input {
            Input::Force => u,
            Input::Voltage => u / scene.drive.motor.r.unwrap_or(1.0),
        };
        let motor = &scene.drive.motor;
        let load_sd = 0.1 * motor.k_m.abs() * current / motor.j;
        Self {
            load_sd,
            load_s: 0.05,
            voltage_sd: 0.01 * u / inductance(scene),
            cycle: None,
            sensors: [1.0; SENSORS],
        }
    }

    /// Where the search begins, with the sizes of the balances.
    pub(super) fn begin(scene: &Scene) -> Option<(Self, References)> {
        let guess = Self::guess(scene);
        let references = scene.references(&scene.tracks(&guess)?);
        let begin = Self {
            load_sd: 0.05 * references.torque / scene.drive.motor.j,
            voltage_sd: 0.02 * references.voltage / inductance(scene),
            load_s: (10.0 * slowest(scene)).max(0.05),
            ..guess
        };
        Some((begin, references))
    }

    /// Found by a search along each of its numbers by factors of at most `step`, the plant linearised
    /// as it is here.
    pub(super) fn searched(
        &self,
        scene: &Scene,
        references: &References,
        mut step: f64,
    ) -> Option<Self> {
        let evidence = Judge::of(scene, references, self)?;
        let evidence = |tried: &Self| evidence.of_randomness(tried);
        let mut best = *self;
        let mut most = evidence(&best)?;
        let has = |output| scene.recordings.iter().any(|it| it.measured.output(output).is_some());
        let mut numbers = vec![0, 1];
        if scene.drive.motor.input == Input::Voltage {
            numbers.push(2);
        }
        if self.cycle.is_some() {
            numbers.extend([6, 7, 8]);
        }
        let outputs = [Output::Current, Output::Speed, Output::Position];
        numbers.extend((0..SENSORS).filter(|it| has(outputs[*it])).map(|it| 3 + it));
        let period = slowest(scene);
        let longest_s = LONGEST_S.max(4.0 * period);
        let mut last = vec![true; numbers.len()];
        while step > 1.25 {
            let mut moved = false;
            for (place, number) in numbers.iter().enumerate() {
                let factors = if last[place] { [step, 1.0 / step] } else { [1.0 / step, step] };
                for (turn, factor) in factors.into_iter().enumerate() {
                    let mut tried = best;
                    match number {
                        0 => tried.load_sd *= factor,
                        1 => {
                            // What the load does within a few samples is told best: it stays.
                            let load_s =
                                (factor * tried.load_s).clamp(SHORTEST * period, longest_s);
                            tried = tried.with_time(load_s);
                        }
                        2 => tried.voltage_sd *= factor,
                        sensor @ 3..6 => tried.sensors[sensor - 3] *= factor,
                        of_cycle => {
                            tried.cycle = tried.cycle.map(|it| it.moved(of_cycle - 6, factor));
                        }
                    }
                    if tried == best {
                        continue;
                    }
                    let now = evidence(&tried).unwrap_or(f64::NEG_INFINITY);
                    if now > most + WORTH {
                        (most, best, moved) = (now, tried, true);
                        last[place] ^= turn == 1;
                        break;
                    }
                }
            }
            if !moved {
                step = step.sqrt();
            }
        }
        Some(best)
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

/// H; 1 where there is no armature.
fn inductance(scene: &Scene) -> f64 {
    scene.drive.motor.l.unwrap_or(1.0)
}

/// Longest sampling time, s.
pub(super) fn slowest(scene: &Scene) -> f64 {
    scene.recordings.iter().map(|it| it.measured.period_s).fold(0.0, f64::max)
}

/// The scene along stretches of the recordings of the fit that are enough to tell its numbers, the
/// same share of each.
pub(super) fn excerpt(scene: &Scene) -> Scene {
    scene.fitted().shortened(ENOUGH)
}
