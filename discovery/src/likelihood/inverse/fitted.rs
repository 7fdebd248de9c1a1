//! A structure at its own best: steps of Gauss and Newton on the table, and the evidence there.

use drivescope_plant::drive::Drive;

use super::super::marginal::standing_out;
use super::super::optimum::{Law, Optimum, Prior, evidence};
use super::super::refine::{SHARES, STEPS, WORTH, moved, step};
use super::super::scene::{Recorded, Scene};
use super::super::weights::CurveWeight;
use super::noise::TorqueNoise;
use super::table::{Columns, Table};
use super::torques::Torques;
use super::weighed::curve_columns;
use super::windows::Windows;
use crate::rms::rms;

/// The scene with the parameters of the machine moved to where its recordings of the fit are most
/// probable, with its table and ln of that probability; nothing where the drive overflows.
pub(super) fn refined(
    scene: Scene,
    windows: &[Windows],
    torque: f64,
    noise: &TorqueNoise,
) -> Option<(Scene, Table, f64)> {
    let at = |scene: &Scene| {
        let table = Table::of_drive(scene, windows, torque);
        let probability = table.probability(noise, false);
        probability.is_finite().then_some((table, probability))
    };
    let (mut table, mut probability) = at(&scene)?;
    let mut best = scene;
    for _ in 0..STEPS {
        let (products, _) = table.products(noise, |held_out| !held_out);
        let Some(step) = step(&best, &products, table.terms.clone(), &table.scale) else { break };
        let better = SHARES.iter().find_map(|share| {
            let scene = moved(&best, &step, *share);
            let (table, more) = at(&scene)?;
            (more > probability).then_some((scene, table, more))
        });
        let Some((scene, along, more)) = better.filter(|it| it.2 > probability + WORTH) else {
            break;
        };
        (best, table, probability) = (scene, along, more);
    }
    Some((best, table, probability))
}

/// The evidence of a structure where it stands: of a law in it, beside a curve perhaps.
pub(super) fn optimum(
    scene: &Scene,
    windows: &[Windows],
    torque: f64,
    noise: &TorqueNoise,
    (law, curve): (Option<&Law<'_>>, Option<&CurveWeight>),
) -> Option<Optimum> {
    let groups: &[usize] = if law.is_some() { &[1] } else { &[] };
    let lost: Vec<Vec<f64>> = match law {
        Some(law) => {
            let each = scene.recordings.iter().zip(windows);
            each.map(|(it, windows)| lost(it, law, windows)).collect()
        }
        None => Vec::new(),
    };
    let further = |recording: usize| {
        let of_curve = curve.map(|it| {
            let columns = curve_columns(&it.curve, scene, recording, &windows[recording]);
            columns.into_iter().map(|column| (column, it.size)).collect()
        });
        Columns {
            background: of_curve.unwrap_or_default(),
            judged: lost.get(recording).cloned().into_iter().collect(),
        }
    };
    let table = Table::of(scene, windows, torque, groups, further);
    let mut terms = table.terms.clone();
    let prior = law.map(|law| Prior::of(law, scene, &table.scale, &mut terms));
    let of = |noise: &TorqueNoise, wanted: &dyn Fn(bool) -> bool| {
        let (products, ln_likelihood) = table.products(noise, wanted);
        ln_likelihood + evidence(products, &terms, prior.as_ref())
    };
    // All recordings together are as random as they are; what those held out say is asked so.
    let (of_fit, of_all): (&dyn Fn(bool) -> bool, &dyn Fn(bool) -> bool) =
        (&|held_out| !held_out, &|_| true);
    let noise_of_all = noise.searched(table.bounds(), |it| of(it, of_all));
    let (fitted, all) = (of(noise, of_fit), of(&noise_of_all, of_all));
    let repeats = all - of(&noise_of_all, of_fit);
    let size = prior.as_ref().map_or(0.0, |prior| {
        let used = lost.iter().zip(windows).flat_map(|(lost, windows)| {
            lost.iter().zip(&windows.moves).filter(|(_, moves)| **moves).map(|(lost, _)| *lost)
        });
        let (products, _) = table.products(noise, |_| true);
        let others = prior.others(table.parameters.clone());
        rms(used) / torque * standing_out(&products, &others, table.terms.columns.len())
    });
    let known = fitted.is_finite() && all.is_finite();
    known.then_some(Optimum { fitted, all, repeats, size, moves: 0.0 })
}

/// What would be missing without the law.
fn lost(it: &Recorded, law: &Law<'_>, windows: &Windows) -> Vec<f64> {
    let mut without: Drive = it.drive.clone();
    without.effects.retain(|effect| effect.id != law.id);
    let of = |drive: &Drive| Torques::of(it, drive, windows, &[]).missing;
    of(&without).iter().zip(of(&it.drive)).map(|(without, with)| without - with).collect()
}
