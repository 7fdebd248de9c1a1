//! Network sizes by AIC, N ln(SSE / N) + 2 K over the free-run errors.

use super::train::{Keep, train_from};
use super::{Structure, Theta, Trained, Training, TrainingError};
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
    /// The start that fits best, with SSE and AIC, as the smallest network of its class.
    pub trained: Trained,
}

/// Trains every candidate in the same way; rows in the order given, and the index of the one with
/// the smallest AIC.
///
/// AIC compares least squares, so of the starts of a candidate the one that fits best counts. One of
/// them is the best network among the candidates that it contains: no structure fits worse than a
/// part of it, however many starts a search would need to find that out by chance. Structures of one
/// class of functions are one model, trained once: they have one figure, and of several with the same
/// one the first is the winner.
pub fn select_structure(
    candidates: &[Structure],
    estimation: &Data,
    validation: &Data,
    training: &Training,
) -> Result<(Vec<StructureRow>, usize), TrainingError> {
    let mut classes: Vec<Structure> = candidates.iter().map(Structure::class).collect();
    classes.sort_by_key(|class| (class.parameters(), class.v1, class.v2, class.order));
    classes.dedup();
    let mut trained: Vec<(Structure, Trained)> = Vec::new();
    for structure in classes {
        let contained = trained.iter().filter(|(class, _)| structure.contains(class));
        let best = contained.min_by(|a, b| a.1.sse.total_cmp(&b.1.sse));
        let smaller: Vec<&Theta> = best.iter().map(|(_, trained)| &trained.theta).collect();
        let data = (estimation, validation);
        let found = train_from(&smaller, Keep::BestFit, structure, data, training)?;
        trained.push((structure, found));
    }
    let row = |structure: &Structure| {
        let class = structure.class();
        let (_, trained) = trained.iter().find(|(of, _)| *of == class)?;
        Some(StructureRow {
            structure: *structure,
            parameters: structure.parameters(),
            effective_parameters: structure.effective_parameters(),
            trained: trained.clone(),
        })
    };
    let rows: Vec<StructureRow> = candidates.iter().filter_map(row).collect();
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
        // A start that stops early leaves a large network worse than a small one, unless it begins
        // where that ended; whatever the order in which they are given.
        let quick = Limits { steps: 4, relative_decrease: 1e-6 };
        let method = Method::LevenbergMarquardt(quick);
        let hasty = Training { method, starts: 1, ..training };
        let mut grid = Structure::grid(1, 1);
        grid.reverse();
        let (rows, _) =
            select_structure(&grid, &data(&estimation), &data(&validation), &hasty).unwrap();
        for (large, small) in rows.iter().flat_map(|large| rows.iter().map(move |s| (large, s))) {
            if large.structure.contains(&small.structure) {
                let bound = small.trained.sse * (1.0 + 1e-9);
                assert!(large.trained.sse <= bound, "{:?} {:?}", large.structure, small.structure);
            }
        }
        // One class of functions, one figure.
        for (one, other) in rows.iter().flat_map(|one| rows.iter().map(move |s| (one, s))) {
            if one.structure.class() == other.structure.class() {
                assert_eq!(one.trained.aic.to_bits(), other.trained.aic.to_bits());
            }
        }
        let none = select_structure(&[], &data(&estimation), &data(&validation), &training);
        assert_eq!(none.unwrap_err(), TrainingError::NoCandidate);
    }
}
