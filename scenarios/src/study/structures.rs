//! How large the process model should be: AIC over structures, and Theorem 1 on an example.

use drivescope_diagnoser::{
    ApproximationExample, ApproximationRow, Limits, Method, Structure, StructureRow, Training,
    select_structure,
};

use super::StudyError;
use super::design::Signals;
use crate::results::{StructureSummary, TheoremRow, TheoremSummary};

/// Starts of every candidate, and their steps: the chosen one is trained again with more.
const STARTS: usize = 2;
const STEPS: usize = 60;

/// The AIC table over the excited runs, to estimate on and to judge, and its winner.
pub(super) fn structures(
    excited: &[Signals; 2],
    seed: u64,
) -> Result<(Vec<StructureSummary>, Structure), StudyError> {
    let [estimation, validation] = excited.each_ref().map(Signals::data);
    let (estimation, validation) = (estimation?, validation?);
    let limits = Limits { steps: STEPS, relative_decrease: 1e-6 };
    let training = Training {
        method: Method::LevenbergMarquardt(limits),
        starts: STARTS,
        seed,
        ..Training::default()
    };
    let grid = Structure::grid(1, 1);
    let (rows, best) = select_structure(&grid, &estimation, &validation, &training)?;
    let winner = rows[best].structure;
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
            paper: row.structure == Structure::PAPER,
            best: k == best,
        }
    };
    Ok((rows.into_iter().enumerate().map(summary).collect(), winner))
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
