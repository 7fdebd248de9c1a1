//! A fitted drive moved to where its recordings are most probable.
//!
//! The minimum of the errors of a free run is not that of the innovations: under a random load, or
//! beside something missing, it lies elsewhere, and evidence compares structures only where each
//! is at its own best. Steps are those of Gauss and Newton on the columns of the base.

use super::base::{Further, Pooled, grams, probability, terms};
use super::gram::References;
use super::marginal::{Terms, coefficients};
use super::randomness::Randomness;
use super::scene::Scene;

/// Steps at most.
const STEPS: usize = 8;
/// Gain in ln of the probability below which no further step is made.
const WORTH: f64 = 0.5;
/// Shares of a step that are tried.
const SHARES: [f64; 3] = [1.0, 0.3, 0.1];
/// Factor by which a value that must be positive moves in a step at most.
const FURTHEST: f64 = 3.0;

/// The scene with the parameters of the machine moved to where its recordings are most probable.
pub(super) fn refined(mut scene: Scene, randomness: &Randomness, references: &References) -> Scene {
    let at = |scene: &Scene| {
        let tracks = scene.tracks(randomness)?;
        let probability = probability(scene, &tracks, references, None, false);
        probability.is_finite().then_some((tracks, probability))
    };
    let Some((mut tracks, mut best)) = at(&scene) else { return scene };
    for _ in 0..STEPS {
        let filters = [tracks.as_slice()];
        let grams = grams(&scene, &filters, references, None, |_| Further::default(), &|| false);
        let terms = terms(&scene);
        let pooled = Pooled::of(&grams[0], terms.columns.len(), &scene, references);
        let Some(step) = step(&scene, &pooled, terms) else { break };
        let better = SHARES.iter().find_map(|share| {
            let moved = moved(&scene, &step, *share);
            let (tracks, now) = at(&moved)?;
            (now > best).then_some((moved, tracks, now))
        });
        let Some((moved, along, now)) = better else { break };
        let gained = now - best;
        (scene, tracks, best) = (moved, along, now);
        if gained < WORTH {
            break;
        }
    }
    scene
}

/// The most probable change of each parameter; one at the end of its range does not leave it.
fn step(scene: &Scene, pooled: &Pooled, mut terms: Terms) -> Option<Vec<f64>> {
    let products = pooled.sum(scene, |_| true);
    let known = scene.drive.parameters();
    let at_end: Vec<bool> = scene
        .names
        .iter()
        .map(|name| known.iter().any(|it| it.name == *name && it.value <= it.range.0))
        .collect();
    loop {
        let mean = coefficients(&products, &terms)?;
        let leaves =
            |place: &usize| at_end[*place] && mean[*place] < 0.0 && terms.variances[*place] > STAYS;
        let Some(leaving) = (0..scene.names.len()).find(leaves) else {
            let of = |place: usize| mean[place] * pooled.scale[place];
            return Some((0..scene.names.len()).map(of).collect());
        };
        terms.variances[leaving] = STAYS;
    }
}

/// Variance of what is not to move.
const STAYS: f64 = 1e-20;

/// The scene after a share of that step; a value that is not possible stays.
fn moved(scene: &Scene, step: &[f64], share: f64) -> Scene {
    let mut moved = scene.clone();
    let known = scene.drive.parameters();
    for (name, step) in scene.names.iter().zip(step) {
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
