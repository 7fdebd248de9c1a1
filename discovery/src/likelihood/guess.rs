//! Where the search for what is random begins, and the samples along which it goes.

use drivescope_plant::drive::Input;

use super::gram::References;
use super::randomness::Randomness;
use super::scene::Scene;
use super::state::SENSORS;
use crate::rms::rms;

/// Samples that tell how random a recording is.
pub(super) const ENOUGH: usize = 4000;

impl Randomness {
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
