//! What every law at its null, and every free curve, would explain of the torque.

use drivescope_plant::effects::grid::Spans;
use drivescope_plant::effects::law::Variable;
use drivescope_plant::model::{POSITION, SPEED};
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::super::marginal::{Beside, log_evidence, standing_out};
use super::super::passes::{LawColumns, Passes};
use super::super::scene::Scene;
use super::super::weighing::{Feedback, Weighing};
use super::super::weights::Weights;
use super::torques::{Torques, Without, shifted};
use super::windows::Windows;
use super::{Columns, Inverse, Table, TorqueNoise};
use crate::discover::{Candidate, Curve, Trajectory, curves};
use crate::response::Forcing;
use crate::rms::rms;

/// Size of the random load over that of the base with which laws and curves are weighed besides: it may
/// have taken what they explain.
const SMALLER: f64 = 0.2;
/// Parts in which a coefficient is tried, between 0 and what explains most of the torque.
const PARTS: usize = 40;

impl Inverse {
    /// Weighs the candidates and the curves beside the drive. `tolerated` names curves that stand in the
    /// background with a standard deviation: what the formula of a named law may leave. Candidates of
    /// which the torque does not tell are left out.
    pub(crate) fn weigh(
        &self,
        candidates: &[Candidate],
        spans: &Spans,
        tolerated: impl Fn(&Curve) -> Option<f64>,
    ) -> Option<Weights> {
        let (scene, windows) = (&self.scene, &self.windows);
        let identified: Vec<Candidate> =
            candidates.iter().filter(|it| self.tells(it)).cloned().collect();
        let number: Vec<usize> =
            (0..candidates.len()).filter(|it| self.tells(&candidates[*it])).collect();
        let each = || scene.recordings.iter().zip(windows);
        let along: Vec<Trajectory> =
            each().map(|(it, windows)| trajectory(&it.measured.u, windows)).collect();
        let mut families = curves(&scene.drive, spans, &along);
        // The driving signal is what is explained: a curve over it explains it by itself.
        families.retain(|curve| !curve.is_over_current());
        let (known, free): (Vec<_>, Vec<_>) = families
            .into_iter()
            .map(|curve| (tolerated(&curve), curve))
            .partition(|it| it.0.is_some());
        let shared = Passes::of(&identified);
        let by = 1e-3 * rms(each().flat_map(|(it, _)| it.measured.u.iter().copied()));
        // Columns of the laws, and by how much each grows with the driving signal, over K.
        let over_current = |pass: usize| {
            let laws = shared.laws[pass].iter().map(|(candidate, _)| &identified[*candidate]);
            laws.into_iter().any(|law| law.fails_over.contains(&Variable::Current))
        };
        let per = by * scene.drive.motor.k_m;
        let laws = |recording: usize| -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
            let (it, windows) = (&scene.recordings[recording], &windows[recording]);
            let moved = shifted(it, by);
            let pass = |pass: usize| {
                let drive = shared.drive(pass, &it.drive, &identified);
                let of = |it| Torques::at_points(it, &drive, windows, &shared.names[pass]).columns;
                let columns = of(it);
                let grows = |(with, without): (Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                    with.iter().zip(without).map(|(with, without)| (with - without) / per).collect()
                };
                let grows = if over_current(pass) {
                    of(&moved).into_iter().zip(&columns).map(grows).collect()
                } else {
                    vec![Vec::new(); columns.len()]
                };
                columns.into_iter().zip(grows)
            };
            (0..shared.laws.len()).into_par_iter().flat_map_iter(pass).unzip()
        };
        let (columns, grows): (Vec<_>, Vec<_>) = (0..scene.recordings.len()).map(laws).unzip();
        // A law without a derivative at its null, shape by shape with the change as it is.
        let shapes: Vec<(usize, usize)> = identified
            .iter()
            .enumerate()
            .filter(|(_, it)| !it.is_linear())
            .flat_map(|(candidate, it)| (0..it.variants.len()).map(move |shape| (candidate, shape)))
            .collect();
        let changes = |recording: usize| -> Vec<Vec<f64>> {
            let (it, windows) = (&scene.recordings[recording], &windows[recording]);
            let without = Without::new(it, windows);
            let change = |(candidate, shape): &(usize, usize)| {
                let candidate = &identified[*candidate];
                without.taken_by(&candidate.added(&it.drive, &candidate.variants[*shape]))
            };
            shapes.par_iter().map(change).collect()
        };
        let changes: Vec<_> = (0..scene.recordings.len()).map(changes).collect();
        let groups: Vec<usize> = shared
            .laws
            .iter()
            .flatten()
            .map(|(candidate, _)| identified[*candidate].coefficients.len())
            .chain(shapes.iter().map(|_| 1))
            .chain(free.iter().map(|(_, curve)| curve.knots.len()))
            .collect();
        let further = |recording: usize| {
            let of = |curve: &Curve| curve_columns(curve, scene, recording, &windows[recording]);
            let known = known.iter().flat_map(|(sd, curve)| {
                of(curve).into_iter().map(move |column| (column, sd.unwrap_or(0.0)))
            });
            let free = free.iter().flat_map(|(_, curve)| of(curve));
            let laws = columns[recording].iter().chain(&changes[recording]).cloned();
            Columns { background: known.collect(), judged: laws.chain(free).collect() }
        };
        let table = Table::of(scene, windows, self.torque, &groups, further);
        let background = table.terms.columns.len();
        let (mut law_columns, mut next) = (Vec::new(), background);
        for (candidate, variant) in shared.laws.iter().flatten() {
            let count = identified[*candidate].coefficients.len();
            let columns = (next..next + count).collect();
            law_columns.push(LawColumns { candidate: *candidate, variant: *variant, columns });
            next += count;
        }
        for (candidate, variant) in &shapes {
            let (candidate, variant) = (*candidate, *variant);
            law_columns.push(LawColumns { candidate, variant, columns: vec![next] });
            next += 1;
        }
        let mut take = |curve: &Curve| {
            next += curve.knots.len();
            (curve.clone(), (next - curve.knots.len()..next).collect::<Vec<usize>>())
        };
        let free: Vec<(Curve, Vec<usize>)> = free.iter().map(|(_, curve)| take(curve)).collect();
        let growth = |law: &LawColumns| -> Option<DMatrix<f64>> {
            let grow = |column: &usize| grows[0].get(column - background);
            if law.columns.iter().any(|column| grow(column).is_none_or(Vec::is_empty)) {
                return None;
            }
            let mut rows = Vec::new();
            for (recording, windows) in windows.iter().enumerate() {
                if scene.recordings[recording].held_out {
                    continue;
                }
                for window in (0..windows.len()).filter(|window| windows.moves[*window]) {
                    rows.extend(law.columns.iter().map(|column| {
                        table.scale[*column] * grows[recording][column - background][window]
                    }));
                }
            }
            let count = law.columns.len();
            Some(DMatrix::from_row_slice(rows.len() / count, count, &rows))
        };
        let growths: Vec<Option<DMatrix<f64>>> = law_columns.iter().map(growth).collect();
        let of = |noise: TorqueNoise| {
            let (fitted, likelihood) = table.products(&noise, |held_out| !held_out);
            let (all, likelihood_of_all) = table.products(&noise, |_| true);
            let beside = Beside::of(&fitted, &table.terms)?;
            let feedback = |law: &LawColumns| {
                let place = law_columns.iter().position(|it| it.columns == law.columns)?;
                let grows = growths[place].as_ref()?;
                let (information, score) = beside.information_and_score(&fitted, &law.columns);
                let most = information.clone().cholesky()?.solve(&score);
                let whole = most.dot(&score);
                let growth = grows * &most;
                let at = |part: f64| {
                    let left = 0.5 * whole * (1.0 - part) * (1.0 - part);
                    let density = |grows: &f64| (1.0 + part * grows).abs().max(1e-9).ln();
                    growth.iter().map(density).sum::<f64>() - left
                };
                let parts = (0..=PARTS).map(|part| part as f64 / PARTS as f64);
                let best = parts.max_by(|a, b| at(*a).total_cmp(&at(*b)))?;
                let out = |column: &usize| standing_out(&fitted, &table.driven, *column);
                let stands_out = law.columns.iter().map(out).fold(0.0, f64::max);
                Some(Feedback { evidence: at(best), part: best, stands_out })
            };
            let (base, base_of_all) = (
                likelihood + log_evidence(&fitted, &table.terms),
                likelihood_of_all + log_evidence(&all, &table.terms),
            );
            let weighing = Weighing {
                fitted: fitted.clone(),
                all,
                scale: &table.scale,
                background: table.terms.clone(),
                parameters: table.parameters.clone(),
                feedback: Some(&feedback),
            };
            let mut laws = weighing.laws(&identified, &law_columns);
            laws.iter_mut().for_each(|law| law.candidate = number[law.candidate]);
            let curves = weighing.curves(free.clone());
            // No formulas are sought along a motion that is known.
            let (plain, left_by_formulas) = (base_of_all, f64::NEG_INFINITY);
            Some(Weights { base, base_of_all, plain, left_by_formulas, laws, curves })
        };
        let each = [self.noise, self.noise.with_load(SMALLER)].into_iter().filter_map(of);
        each.reduce(Weights::best_of)
    }
}

/// A curve's hats over the windows of a recording.
pub(super) fn curve_columns(
    curve: &Curve,
    scene: &Scene,
    recording: usize,
    windows: &Windows,
) -> Vec<Vec<f64>> {
    let it = &scene.recordings[recording];
    let along = trajectory(&it.measured.u, windows);
    let forcings = curve.forcings(&it.drive, &it.measured, &along);
    forcings.iter().map(|it: &Forcing| windows.over(&it.torque)).collect()
}

/// The variables along a recording.
fn trajectory(u: &[f64], windows: &Windows) -> Trajectory {
    let of = |place: usize| windows.motion.iter().map(|at| at[place]).collect();
    Trajectory { current: u.to_vec(), speed: of(SPEED), position: of(POSITION) }
}
