//! How large the process model should be: AIC over structures, and Theorem 1 on an example.
//!
//! AIC knows the excitation (25) only, and what a large network does between its few frequencies costs
//! nothing there. A closed loop excites all of them: the residual of a healthy run may be ten times as
//! wide as a smaller network's, and constant thresholds are as wide as it is. So AIC chooses among the
//! sizes that a healthy run, which none was fitted on, does not tell apart.

use drivescope_diagnoser::{
    ApproximationExample, ApproximationRow, Data, Limits, Method, Start, Structure, StructureRow,
    Trained, Training, residual, select_structure,
};

use super::signals::mean_and_deviation;
use super::{RUN_UP, StudyError};
use crate::results::{StructureSummary, TheoremRow, TheoremSummary};

/// Starts of every candidate, and their steps.
const STARTS: usize = 2;
const STEPS: usize = 60;
/// Share by which deviations of healthy runs may differ and count as equal.
const EQUAL: f64 = 0.1;

/// The AIC table over the excited runs, to estimate on and to judge, of networks with that memory, and
/// the network to use: the winner among those whose free run on the healthy run is close to the best.
pub(super) fn structures(
    [estimation, validation]: &[Data; 2],
    healthy: &Data,
    (memory, seed): (Option<usize>, u64),
) -> Result<(Vec<StructureSummary>, Trained), StudyError> {
    let limits = Limits { steps: STEPS, relative_decrease: 1e-6 };
    let training = Training {
        method: Method::LevenbergMarquardt(limits),
        starts: STARTS,
        seed,
        ..Training::default()
    };
    let grid = Structure::grid(1, 1).into_iter();
    let grid: Vec<_> = grid.map(|sizes| Structure { memory, ..sizes }).collect();
    let (rows, best) = select_structure(&grid, estimation, validation, &training)?;
    let deviation = |row: &StructureRow| {
        let left = residual(&mut row.trained.network.run(), healthy, Start::Rest);
        mean_and_deviation(&left[RUN_UP..]).1
    };
    let healthy: Vec<f64> = rows.iter().map(deviation).collect();
    let aics: Vec<f64> = rows.iter().map(|row| row.trained.aic).collect();
    let used = least_aic_of_the_close(&aics, &healthy);
    let process = rows[used].trained.clone();
    let summary = |(k, row): (usize, StructureRow)| {
        let Structure { v1, v2, order, .. } = row.structure;
        // Errors of the starts are in deviations of the output.
        let unit = row.trained.network.output_scales[0].deviation;
        StructureSummary {
            v1,
            v2,
            order,
            parameters: row.parameters,
            effective_parameters: row.effective_parameters,
            aic: row.trained.aic,
            validation: unit * row.trained.starts[row.trained.best].validation,
            healthy: healthy[k],
            paper: row.structure == Structure { memory, ..Structure::PAPER },
            best: k == best,
            used: k == used,
        }
    };
    Ok((rows.into_iter().enumerate().map(summary).collect(), process))
}

/// The least AIC among those of deviations that are close to the least one.
fn least_aic_of_the_close(aics: &[f64], deviations: &[f64]) -> usize {
    let least = deviations.iter().copied().fold(f64::INFINITY, f64::min);
    let close = (0..aics.len()).filter(|k| deviations[*k] <= (1.0 + EQUAL) * least);
    close.min_by(|a, b| aics[*a].total_cmp(&aics[*b])).unwrap_or(0)
}

/// Networks of growing size in place of a system that they are not.
pub(super) fn theorem() -> Result<TheoremSummary, StudyError> {
    let ApproximationExample { epsilon, horizon, rows } = ApproximationExample::compute()?;
    let row = |ApproximationRow { structure, max_error }| {
        let Structure { v1, v2, order, .. } = structure;
        TheoremRow { v1, v2, order, max_error }
    };
    Ok(TheoremSummary { epsilon, horizon, rows: rows.into_iter().map(row).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_healthy_run_tells_apart_is_not_left_to_aic() {
        let aics = [-5000.0, -8000.0, -8500.0, -8900.0];
        assert_eq!(least_aic_of_the_close(&aics, &[5.8, 6.0, 6.1, 18.0]), 2);
        assert_eq!(least_aic_of_the_close(&aics, &[5.8, 6.0, 6.1, 6.2]), 3);
        // One that diverges is none, and of equals the first is taken.
        assert_eq!(least_aic_of_the_close(&[-1.0, -1.0, -2.0], &[6.0, 6.0, f64::NAN]), 0);
    }
}
