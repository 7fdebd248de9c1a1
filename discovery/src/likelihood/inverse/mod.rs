//! The balance of torques read backwards: what must have driven a motion that is known.
//!
//! Where a controller holds the motion, the motion says nothing of what disturbs it: a model in which
//! nothing moves the shaft predicts it as well as any. The torque that the controller asked for says
//! it. So of drives whose torque (or current) and position were measured, the torque is the datum and
//! the motion is given, as robots are identified (Gautier and Khalil, IEEE Trans. Robotics and
//! Automation 6, 1990; Janot, Vandanjon and Gautier, IEEE Trans. Control Systems Technology 22, 2014).
//! Random beside it are a load with a memory and noise without; laws, curves and their evidence are
//! those of the filter.
//!
//! ```text
//!  recordings ──> windows: motion, second differences ──> table: a row a window, a column a parameter
//!      ──whitened by the noise──> products ──> weighed: laws and curves;  fitted: a law at its best
//! ```

mod fitted;
mod noise;
mod table;
mod torques;
mod weighed;
mod windows;

use drivescope_plant::drive::{Drive, EffectData, Input};

use super::optimum::{Law, Optimum};
use super::scene::Scene;
use super::weights::CurveWeight;
use crate::balances::UNIDENTIFIED_INERTIA;
use crate::discover::{Candidate, RandomLoad};
use crate::measured::Output;
use crate::rms::rms;

use noise::TorqueNoise;
use table::{Columns, Table};
use windows::{Windows, every, way};

/// Noise of the acceleration that is taken for known, as a torque, over the torque that drives.
const KNOWN: f64 = 0.1;
/// The same of the inertia that the run has, where the balance may have found too small a one: of a motion
/// that the torque hardly moves it says nothing, and no inertia leaves the least of it.
const BLIND: f64 = 0.3;
/// Fewest windows in which the shaft moves.
const FEWEST: usize = 100;
/// The inertia, by its name in a drive.
const INERTIA: &str = "J";
/// Rounds of a fit and a search for the noise: each moves the other.
const ROUNDS: usize = 3;

/// A drive at its own best along a known motion.
pub(crate) struct Inverse {
    pub(crate) scene: Scene,
    windows: Vec<Windows>,
    /// Size of the balance, N m (N): the torque that is left once the inertia has its share.
    torque: f64,
    noise: TorqueNoise,
    pub(crate) base: Optimum,
}

impl Inverse {
    /// Nothing where the torque or the motion is not known well enough, or the drive overflows.
    pub(crate) fn of(scene: Scene) -> Option<Self> {
        let windows = known_motion(&scene)?;
        // As the run knows it.
        let run = scene.drive.motor.j;
        let torque = resisting(&scene, &windows);
        let noise = Table::of_drive(&scene, &windows, torque).noise();
        let found = Self::at(scene, windows, torque, noise)?;
        let moving = found.windows.iter().flat_map(|it| &it.moves).filter(|it| **it).count();
        let driving = driving(&found.scene);
        let inertia = found.scene.drive.motor.j;
        let noisy = |it: &Windows| {
            inertia * it.acceleration_sd > KNOWN * driving
                || run * it.acceleration_sd > BLIND * driving
        };
        (moving >= FEWEST && !found.windows.iter().any(noisy)).then_some(found)
    }

    fn at(
        mut scene: Scene,
        windows: Vec<Windows>,
        torque: f64,
        mut noise: TorqueNoise,
    ) -> Option<Self> {
        for _ in 0..ROUNDS {
            let (moved, table, _) = fitted::refined(scene.clone(), &windows, torque, &noise)?;
            let (moved, table) = heavy_enough(moved, &windows, torque, table);
            let searched = noise.searched(table.bounds(), |it| table.probability(it, true));
            let same = moved.drive == scene.drive && searched == noise;
            (scene, noise) = (moved, searched);
            if same {
                break;
            }
        }
        let torque = resisting(&scene, &windows);
        let base = fitted::optimum(&scene, &windows, torque, &noise, (None, None))?;
        Some(Self { scene, windows, torque, noise, base })
    }

    /// What is random in the load.
    pub(crate) fn load(&self) -> RandomLoad {
        RandomLoad { sd: self.noise.load, time: self.noise.load_s, oscillation: None }
    }

    /// The same where every recording has a disturbance of its own of that law.
    pub(crate) fn beside(&self, law: &EffectData, coefficients: &[String]) -> Option<Self> {
        let scene = self.scene.disturbed(law, coefficients);
        Self::at(scene, self.windows.clone(), self.torque, self.noise)
    }

    /// The drive with one of those effects at its own best, and the evidence there: the effects are
    /// start values of the same law, of which the best is followed. `estimated` are the parameters of the
    /// effect that are free, `coefficients` those that are 0 where it vanishes.
    pub(crate) fn with(
        &self,
        effects: &[EffectData],
        estimated: &[String],
        coefficients: &[String],
    ) -> Option<(Drive, Optimum)> {
        let fit = |scene: Scene, noise: &TorqueNoise| {
            fitted::refined(scene, &self.windows, self.torque, noise)
        };
        let begin = |effect: &EffectData| {
            fit(self.scene.with(effect, estimated.iter().cloned()), &self.noise)
        };
        let begun = effects.iter().filter_map(begin);
        let (scene, table, _) = begun.max_by(|a, b| a.2.total_cmp(&b.2))?;
        let noise = self.noise.searched(table.bounds(), |it| table.probability(it, true));
        let (scene, ..) = fit(scene, &noise)?;
        let law = Law { id: &scene.drive.effects.last()?.id.clone(), coefficients };
        let of = (Some(&law), None);
        let optimum = fitted::optimum(&scene, &self.windows, self.torque, &noise, of)?;
        Some((scene.drive, optimum))
    }

    /// Evidence of a fitted scene where a curve explains what it can; nothing where the drive overflows.
    pub(crate) fn beside_curve(
        &self,
        scene: &Scene,
        law: Option<&Law<'_>>,
        curve: &CurveWeight,
    ) -> Option<Optimum> {
        fitted::optimum(scene, &self.windows, self.torque, &self.noise, (law, Some(curve)))
    }

    /// Whether the balance of torques along a known motion tells of that law.
    pub(crate) fn tells(&self, candidate: &Candidate) -> bool {
        let plain = candidate.is_linear() && !candidate.info.stiff;
        // A load that moves by itself follows the motion too; when its teeth meet, nobody knows.
        let follows = candidate.has_load() && !candidate.info.knocks;
        (plain || follows) && candidate.acts_at_motor()
    }
}

/// Root of the mean square of the torque that drives, N m (N).
fn driving(scene: &Scene) -> f64 {
    let k_m = scene.drive.motor.k_m;
    rms(scene.recordings.iter().flat_map(|it| it.measured.u.iter().map(|u| k_m * u)))
}

/// The recordings in windows, where torque and position were measured and nothing beside the motor.
fn known_motion(scene: &Scene) -> Option<Vec<Windows>> {
    let of_motor = |output| matches!(output, Output::Speed | Output::Position);
    let each = || scene.recordings.iter();
    let known = |it: &super::scene::Recorded| {
        way(it).is_some() && it.measured.outputs.iter().all(|it| of_motor(it.output))
    };
    if scene.drive.motor.input != Input::Force || !each().all(known) {
        return None;
    }
    let lasts = each().map(|it| it.measured.len() as f64 * it.measured.period_s);
    let longest_s = lasts.fold(0.0, f64::max);
    let of = |finer: usize| -> Option<Vec<Windows>> {
        each().map(|it| Windows::of(it, every(&it.measured, longest_s, finer))).collect()
    };
    let torque = KNOWN * driving(scene);
    let quiet = |it: &Windows| scene.drive.motor.j * it.acceleration_sd <= torque;
    // A motion that turns often hardly goes one way throughout a window: shorter ones then, as far as
    // noise allows.
    let (mut windows, mut finer) = (of(1)?, 1);
    let hardly = |windows: &[Windows]| {
        let moving_s: f64 = windows.iter().map(Windows::moving_s).sum();
        2.0 * moving_s < windows.iter().map(|it| it.one_way_s).sum()
    };
    while hardly(&windows) {
        finer *= 2;
        let shorter = of(finer)?;
        let same = shorter.iter().zip(&windows).all(|(it, was)| it.len() == was.len());
        if same || !shorter.iter().all(quiet) {
            break;
        }
        windows = shorter;
    }
    Some(windows)
}

/// The scene, with a greater inertia where it has less than what takes [`UNIDENTIFIED_INERTIA`] of the
/// torque: along a motion that tells none it would fall without end, and no step of time would resolve
/// the drive.
fn heavy_enough(
    mut scene: Scene,
    windows: &[Windows],
    torque: f64,
    table: Table,
) -> (Scene, Table) {
    let acceleration = rms(windows.iter().flat_map(|it| it.acceleration.iter().copied()));
    let least = UNIDENTIFIED_INERTIA * driving(&scene) / acceleration;
    if !(scene.names.iter().any(|it| it == INERTIA)
        && scene.drive.motor.j < least
        && least.is_finite())
    {
        return (scene, table);
    }
    scene.set(INERTIA, least);
    let table = Table::of_drive(&scene, windows, torque);
    (scene, table)
}

/// Size of the balance of a drive: rms of the torque that drives less that of the inertia.
fn resisting(scene: &Scene, windows: &[Windows]) -> f64 {
    let each = scene.recordings.iter().zip(windows).flat_map(|(it, windows)| {
        let motor = &it.drive.motor;
        let driving = windows.over(&it.measured.u).into_iter().zip(&windows.acceleration);
        let moving = driving.zip(&windows.moves).filter(|(_, moves)| **moves);
        let left = moving.map(|((u, a), _)| motor.k_m * u - motor.j * a);
        left.collect::<Vec<f64>>()
    });
    rms(each)
}
