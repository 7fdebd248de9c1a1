//! How random the load, the voltage and the sensors are: what makes the recordings most probable.

use super::filter::SENSORS;
use super::gram::References;
use super::noise::{Cycle, Noise};
use super::scene::{Scene, rms};
use drivescope_plant::drive::Input;

/// Correlation time of the random voltage, s.
const VOLTAGE_S: f64 = 0.02;

/// Samples that tell how random a recording is.
pub(super) const ENOUGH: usize = 4000;

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
