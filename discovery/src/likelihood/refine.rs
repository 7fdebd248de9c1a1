//! A fitted drive moved to where its recordings are most probable.
//!
//! The minimum of the errors of a free run is not that of the innovations: under a random load, or
//! beside something missing, it lies elsewhere, and evidence compares structures only where each
//! is at its own best. Steps are those of Gauss and Newton on the columns of the base.

use super::base::{nuisance, pooled, probability, terms};
use super::gram::{Products, References};
use super::marginal::{Terms, coefficients, explained};
use super::randomness::Randomness;
use super::scene::{Scene, longest};

/// Steps at most.
pub(super) const STEPS: usize = 8;
/// Gain in ln of the probability below which no further step is made.
pub(super) const WORTH: f64 = 0.5;
/// Share of a value that a step moves at most where the columns hold at its end too, and by how much they
/// may promise too little there (of a real joint, a third of what came). Where not even that makes a step
/// worth its while none is tried.
const NEAR: f64 = 0.1;
const TOO_LITTLE: f64 = 5.0;
/// Shares of a step that are tried.
pub(super) const SHARES: [f64; 3] = [1.0, 0.3, 0.1];
/// Factor by which a value that must be positive moves in a step at most.
const FURTHEST: f64 = 3.0;
/// Sub-steps a sample beyond which a drive does not become faster: samples do not tell an inductance,
/// say, whose time constant is a small part of one, and stepping it would take for ever.
const SUBSTEPS: f64 = 20.0;

/// A scene and how probable its recordings are with it, ln.
pub(super) struct Refined {
    pub(super) scene: Scene,
    pub(super) probability: f64,
}

/// The scene with the parameters of the machine moved to where its recordings are most probable;
/// nothing where the drive overflows.
pub(super) fn refined(
    scene: Scene,
    randomness: &Randomness,
    references: &References,
) -> Option<Refined> {
    let at = |scene: &Scene| {
        let tracks = scene.tracks(randomness)?;
        let pooled = pooled(scene, &tracks, references, None);
        let probability = probability(scene, &tracks, &pooled, false);
        probability.is_finite().then_some((pooled, probability))
    };
    let each = scene.recordings.iter().map(|it| it.measured.period_s);
    let shortest_s =
        longest(&scene.drive, scene.speed).min(each.fold(f64::INFINITY, f64::min) / SUBSTEPS);
    let (mut products, probability) = at(&scene)?;
    let mut best = Refined { scene, probability };
    for _ in 0..STEPS {
        let sum = products.sum(&best.scene, |_| true);
        let Some(step) = step(&best.scene, &sum, terms(&best.scene), &products.scale) else {
            break;
        };
        if !step.is_worth_trying(&best.scene) {
            break;
        }
        let better = SHARES.iter().find_map(|share| {
            let scene = moved(&best.scene, &step, *share);
            if longest(&scene.drive, scene.speed) < shortest_s {
                return None;
            }
            let (products, probability) = at(&scene)?;
            (probability > best.probability).then_some((products, Refined { scene, probability }))
        });
        let Some((along, more)) =
            better.filter(|(_, it)| it.probability > best.probability + WORTH)
        else {
            break;
        };
        (products, best) = (along, more);
    }
    Some(best)
}

/// A step of Gauss and Newton.
pub(super) struct Step {
    /// Change of each parameter.
    changes: Vec<f64>,
    /// What the columns promise at its end, in ln of the probability.
    promises: f64,
}

impl Step {
    /// Whether its end may be more probable by what a step is worth.
    fn is_worth_trying(&self, scene: &Scene) -> bool {
        let known = scene.drive.parameters();
        let near = |(name, change): (&String, &f64)| {
            let value = known.iter().find(|it| it.name == *name).map(|it| it.value);
            value.is_some_and(|value| change.abs() <= NEAR * value.abs())
        };
        TOO_LITTLE * self.promises >= WORTH || !scene.names.iter().zip(&self.changes).all(near)
    }
}

/// The most probable change of each parameter, whose columns are the first of the `terms` and in units
/// of that `scale`; one at the end of its range does not leave it.
pub(super) fn step(
    scene: &Scene,
    products: &Products,
    mut terms: Terms,
    scale: &[f64],
) -> Option<Step> {
    let known = scene.drive.parameters();
    let at_end: Vec<bool> = scene
        .names
        .iter()
        .map(|name| known.iter().any(|it| it.name == *name && it.value <= it.range.0))
        .collect();
    loop {
        let mean = coefficients(products, &terms)?;
        let leaves =
            |place: &usize| at_end[*place] && mean[*place] < 0.0 && terms.variances[*place] > STAYS;
        let Some(leaving) = (0..scene.names.len()).find(leaves) else {
            let of = |place: usize| mean[place] * scale[place];
            let promises = explained(products, &terms)? - explained(products, &nuisance(&terms))?;
            return Some(Step { changes: (0..scene.names.len()).map(of).collect(), promises });
        };
        terms.variances[leaving] = STAYS;
    }
}

/// Variance of what is not to move.
const STAYS: f64 = 1e-20;

/// The scene after a share of that step; a value that is not possible stays.
pub(super) fn moved(scene: &Scene, step: &Step, share: f64) -> Scene {
    let mut moved = scene.clone();
    let known = scene.drive.parameters();
    for (name, step) in scene.names.iter().zip(&step.changes) {
        let Some(before) = known.iter().find(|it| it.name == *name) else { continue };
        let ((low, _), value, step) = (before.range, before.value, share * step);
        let after = if low >= 0.0 && value > 0.0 {
            // In its logarithm, so that no step leaves what is possible.
            value * (step / value).clamp(-FURTHEST.ln(), FURTHEST.ln()).exp()
        } else {
            (value + step).max(low)
        };
        moved.set(name, after);
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Setting;
    use crate::discover::Model;
    use crate::estimate::{Evidence, Options};
    use crate::measured::Measured;
    use crate::observer::Observer;
    use crate::testing::{bench, dr300, noisy};

    /// The armature settles within a hundredth of a sample: that it is fast is told, and how fast is
    /// not.
    #[test]
    fn a_drive_does_not_become_faster_than_its_samples_tell() {
        let period_s = 0.001;
        let mut truth = dr300();
        truth.motor.l = Some(2e-6);
        let recording = noisy(bench(&truth, 1.5, period_s), [0.01, 0.3], 5);
        let base = dr300();
        let measured = Measured::new(&base, &recording).expect("usable");
        let evidence = Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] };
        let setting = Setting::new(&base, Observer::NONE);
        let as_it_is = Options { steps: 0, ..Options::NEAR };
        let model = Model::fit(&base, &evidence, &evidence, setting, &as_it_is, &|_| false);
        let scene = Scene::of(&model.expect("it runs"), &evidence, &evidence);
        let (randomness, references) = Randomness::begin(&scene).expect("it runs");
        let found = refined(scene, &randomness, &references).expect("it runs").scene;
        let l = found.drive.motor.l.expect("an armature");
        assert!(l < 0.3 * base.motor.l.expect("an armature"), "{l}");
        assert!(longest(&found.drive, found.speed) >= period_s / SUBSTEPS, "{l}");
    }
}
