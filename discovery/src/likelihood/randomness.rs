//! How random the load, the voltage and the sensors are: what makes the recordings most probable.

use super::base::Base;
use super::filter::{Noise, SENSORS};
use super::gram::References;
use super::scene::{Recorded, Scene, rms};
use crate::measured::{Measured, Output};
use drivescope_plant::drive::Input;

/// Longest correlation time of a random load, s: what stays the same for longer is a load.
const LONGEST_S: f64 = 1.0;
/// Shortest one over the sampling time.
const SHORTEST: f64 = 2.0;
/// Correlation time of the random voltage, s.
const VOLTAGE_S: f64 = 0.02;
/// Gain in ln of the likelihood that a step of the search must bring.
const WORTH: f64 = 0.5;

/// Samples that tell how random a recording is, and the stretches in which they are taken of each.
const ENOUGH: usize = 4000;
const STRETCHES: usize = 2;

/// Two disturbances, and factors on what is known of the sensors' noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Randomness {
    /// Standard deviation, N m (N), and correlation time, s, of the load.
    pub(crate) load_sd: f64,
    pub(crate) load_s: f64,
    /// Standard deviation of the voltage, V.
    pub(crate) voltage_sd: f64,
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
            sensors: std::array::from_fn(|sensor| self.sensors[sensor] * noise[sensor]),
        }
    }

    /// With a load of another size.
    pub(crate) fn scaled(&self, load: f64) -> Self {
        Self { load_sd: load * self.load_sd, ..*self }
    }

    /// A first guess, from what drives.
    fn guess(scene: &Scene<'_>) -> Self {
        let u = rms(scene.recordings.iter().flat_map(|it| it.measured.u.iter().copied()));
        let current = match scene.drive.motor.input {
            Input::Force => u,
            Input::Voltage => u / scene.drive.motor.r.unwrap_or(1.0),
        };
        let load_sd = 0.1 * scene.drive.motor.k_m.abs() * current;
        Self { load_sd, load_s: 0.05, voltage_sd: 0.01 * u, sensors: [1.0; SENSORS] }
    }

    /// Found by a search along each of its numbers on the recordings of the fit, with the sizes of
    /// the balances.
    pub(crate) fn of(scene: &Scene<'_>) -> Option<(Self, References)> {
        let parts = parts(scene);
        let scene = scene.fitted().along(&parts);
        let guess = Self::guess(&scene);
        let references = scene.references(&scene.tracks(&guess)?);
        let period = scene.recordings.iter().map(|it| it.measured.period_s).fold(0.0, f64::max);
        let mut best = Self {
            load_sd: 0.05 * references.torque,
            voltage_sd: 0.02 * references.voltage,
            load_s: (10.0 * period).max(0.05),
            ..guess
        };
        let evidence = |tried: &Self| Base::evidence(&scene, tried, &references);
        let mut most = evidence(&best)?;
        let has = |output| scene.recordings.iter().any(|it| it.measured.output(output).is_some());
        let mut numbers = vec![0, 1];
        if scene.drive.motor.input == Input::Voltage {
            numbers.push(2);
        }
        let outputs = [Output::Current, Output::Speed, Output::Position];
        numbers.extend((0..SENSORS).filter(|it| has(outputs[*it])).map(|it| 3 + it));
        let longest_s = LONGEST_S.max(4.0 * period);
        let mut step: f64 = 3.0;
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
                            tried.load_s =
                                (factor * tried.load_s).clamp(SHORTEST * period, longest_s);
                        }
                        2 => tried.voltage_sd *= factor,
                        sensor => tried.sensors[sensor - 3] *= factor,
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
        Some((best, references))
    }
}

/// Stretches of the recordings of the fit that are enough to tell how random they are, the same
/// share of each.
fn parts(scene: &Scene<'_>) -> Vec<(usize, Measured)> {
    let all: usize =
        scene.recordings.iter().filter(|it| !it.held_out).map(|it| it.measured.len()).sum();
    let share = (ENOUGH as f64 / all as f64).min(1.0);
    let fitted = scene.recordings.iter().enumerate().filter(|(_, it)| !it.held_out);
    let cut = |(number, it): (usize, &Recorded<'_>)| {
        let n = it.measured.len();
        let length = (share * n as f64 / STRETCHES as f64) as usize;
        let stretch = move |k: usize| {
            let from = (k as f64 / STRETCHES as f64 * n as f64) as usize;
            from..(from + length).min(n)
        };
        let one = move |k: usize| it.measured.part(stretch(k)).ok().map(|part| (number, part));
        (0..STRETCHES).filter_map(one).collect::<Vec<_>>()
    };
    let parts: Vec<(usize, Measured)> = fitted.flat_map(cut).collect();
    if share < 1.0 && !parts.is_empty() {
        return parts;
    }
    let whole = scene.recordings.iter().enumerate().filter(|(_, it)| !it.held_out);
    whole.map(|(number, it)| (number, it.measured.clone())).collect()
}
