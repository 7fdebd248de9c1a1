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
    best.map(|best| (rows, best)).ok_or(TrainingError::NoCandidate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::data;
    use crate::network::Method;
    use crate::testing::multisine;
    use drivescope_numerics::Limits;

    #[test]
    fn dry_friction_asks_for_neurons_and_idle_ones_are_not_chosen() {
        let (estimation, validation) = (multisine(700, 1), multisine(700, 2));
        let method = Method::LevenbergMarquardt(Limits { steps: 50, relative_decrease: 1e-6 });
        let training = Training { method, starts: 3, ..Training::default() };
        let candidates = [
            Structure { v1: 1, v2: 1, ..Structure::PAPER },
            Structure { v1: 2, v2: 1, ..Structure::PAPER },
            Structure::PAPER,
        ];
        let (rows, best) =
            select_structure(&candidates, &data(&estimation), &data(&validation), &training)
                .unwrap();
        assert_eq!(rows.iter().map(|row| row.structure).collect::<Vec<_>>(), candidates);
        assert!(best > 0, "one neuron for a curve with a corner at zero");
        assert!(rows.iter().all(|row| row.trained.aic >= rows[best].trained.aic));
        let none = select_structure(&[], &data(&estimation), &data(&validation), &training);
        assert_eq!(none.unwrap_err(), TrainingError::NoCandidate);
    }
}
