//! Network sizes by AIC, N ln(SSE / N) + 2 K over the free-run errors.

use super::{Structure, Trained, Training, TrainingError, train};
use crate::data::Data;

/// One candidate, trained.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureRow {
    /// Its sizes.
    pub structure: Structure,
    /// Parameters as written.
    pub parameters: usize,
    /// K: those that the data can tell apart.
    pub effective_parameters: usize,
    /// The best of its starts, with SSE and AIC.
    pub trained: Trained,
}

/// Trains every candidate in the same way; rows in the order given, and the index of the one with
/// the smallest AIC.
pub fn select_structure(
    candidates: &[Structure],
    estimation: &Data,
    validation: &Data,
    training: &Training,
) -> Result<(Vec<StructureRow>, usize), TrainingError> {
    let row = |structure: &Structure| {
        Ok(StructureRow {
            structure: *structure,
            parameters: structure.parameters(),
            effective_parameters: structure.effective_parameters(),
            trained: train(*structure, estimation, validation, training)?,
        })
    };
    let rows = candidates.iter().map(row).collect::<Result<Vec<_>, TrainingError>>()?;
    let best = (0..rows.len()).min_by(|a, b| rows[*a].trained.aic.total_cmp(&rows[*b].trained.aic));
    best.map(|best| (rows, best)).ok_or(TrainingError::NoStart)
}
