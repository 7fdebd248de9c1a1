//! How large the process model should be, and Theorem 1 on an example.

use drivescope_diagnoser::{
    ApproximationExample, ApproximationRow, Data, Limits, Method, Selection, Structure,
    StructureRow, Trained, Training, select_structure,
};

use super::{RUN_UP, StudyError};
use crate::results::{StructureSummary, TheoremRow, TheoremSummary};

/// Starts of every candidate, and their steps.
const STARTS: usize = 2;
const STEPS: usize = 60;

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
    let (excited, healthy) = ([estimation, validation], (healthy, RUN_UP));
    let found = select_structure(&grid, excited, healthy, &training)?;
    let process = found.network().clone();
    let Selection { rows, best, used } = found;
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
            healthy: row.healthy,
            paper: row.structure == Structure { memory, ..Structure::PAPER },
            best: k == best,
            used: k == used,
        }
    };
    Ok((rows.into_iter().enumerate().map(summary).collect(), process))
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
