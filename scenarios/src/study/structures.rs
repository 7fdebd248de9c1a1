//! How large the process model should be, and Theorem 1 on an example.

use drivescope_diagnoser::{
    ApproximationExample, ApproximationRow, Recipe, Selection, Sets, Structure, StructureRow,
    Trained,
};

use super::StudyError;
use crate::results::{StructureSummary, TheoremRow, TheoremSummary};

/// The AIC table, and the network to use: the winner among those whose free run on a healthy run is
/// close to the best.
pub(super) fn structures(
    recipe: &Recipe,
    sets: &Sets,
) -> Result<(Vec<StructureSummary>, Trained), StudyError> {
    let found = recipe.compare_sizes(sets)?;
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
            paper: row.structure == recipe.structure,
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
