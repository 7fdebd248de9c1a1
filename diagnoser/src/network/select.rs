//! Network sizes by AIC, N ln(SSE / N) + 2 K over the free-run errors.
//!
//! AIC knows the excitation only, and what a large network does between its few frequencies costs
//! nothing there. A closed loop excites all of them: the residual of a healthy run may be ten times as
//! wide as a smaller network's, and constant thresholds are as wide as it is. So AIC chooses among the
//! sizes that a healthy run, which none was fitted on, does not tell apart.

use super::train::{Keep, train_from};
use super::{Structure, Theta, Trained, Training, TrainingError};
use crate::data::Data;
use crate::signal_model::residual;
use crate::threshold::mean_and_deviation;

/// Share by which deviations of healthy runs may differ and count as equal.
const EQUAL: f64 = 0.1;

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
    /// Standard deviation of the residual of the healthy run, unit of the output.
    pub healthy: f64,
}

/// Candidates that were compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// All of them, in the order given.
    pub rows: Vec<StructureRow>,
    /// Place of the smallest AIC.
    pub best: usize,
    /// Place of the one to use: the smallest AIC of those whose residual on the healthy run is close to
    /// the least one.
    pub used: usize,
}

impl Selection {
    /// The network to use.
    pub fn network(&self) -> &Trained {
        &self.rows[self.used].trained
    }
}

/// Trains every candidate in the same way. `run_up` samples of every segment of the healthy run only
/// settle the models.
///
/// AIC compares least squares, so of the starts of a candidate the one that fits best counts. One of
/// them is the best network among the candidates that it contains: no structure fits worse than a
/// part of it, however many starts a search would need to find that out by chance. Structures of one
/// class of functions are one model, trained once: they have one figure, and of several with the same
/// one the first is the winner.
///
/// # Errors
/// [`TrainingError`]; [`TrainingError::NoCandidate`] where there is none.
pub(crate) fn select_structure(
    candidates: &[Structure],
    [estimation, validation]: [&Data; 2],
    (healthy, run_up): (&Data, usize),
    training: &Training,
) -> Result<Selection, TrainingError> {
    let mut classes: Vec<Structure> = candidates.iter().map(Structure::class).collect();
    classes.sort_by_key(|class| (class.parameters(), class.v1, class.v2, class.order));
    classes.dedup();
    let deviation = |trained: &Trained| {
        let remainder = residual(&mut trained.network.run(), healthy, training.start);
        mean_and_deviation(&healthy.judged(&remainder, run_up)).1
    };
    let mut trained: Vec<(Structure, Trained, f64)> = Vec::new();
    for structure in classes {
        let contained = trained.iter().filter(|(class, ..)| structure.contains(class));
        let best = contained.min_by(|a, b| a.1.sse.total_cmp(&b.1.sse));
        let smaller: Vec<&Theta> = best.iter().map(|(_, trained, _)| &trained.theta).collect();
        let data = (estimation, validation);
        let found = train_from(&smaller, Keep::BestFit, structure, data, training)?;
        let healthy = deviation(&found);
        trained.push((structure, found, healthy));
    }
    let row = |structure: &Structure| {
        let class = structure.class();
        let (_, trained, healthy) = trained.iter().find(|(of, ..)| *of == class)?;
        Some(StructureRow {
            structure: *structure,
            parameters: structure.parameters(),
            effective_parameters: structure.effective_parameters(),
            trained: trained.clone(),
            healthy: *healthy,
        })
    };
    let rows: Vec<StructureRow> = candidates.iter().filter_map(row).collect();
    let aics: Vec<f64> = rows.iter().map(|row| row.trained.aic).collect();
    let deviations: Vec<f64> = rows.iter().map(|row| row.healthy).collect();
    let best = least(&aics, 0..rows.len()).ok_or(TrainingError::NoCandidate)?;
    let used = least_of_the_close(&aics, &deviations).unwrap_or(best);
    Ok(Selection { rows, best, used })
}

/// The place of the least of some values; the first of equals.
fn least(values: &[f64], places: impl Iterator<Item = usize>) -> Option<usize> {
    places.min_by(|a, b| values[*a].total_cmp(&values[*b]))
}

/// The place of the least AIC among those of deviations that are close to the least one; none where no
/// deviation is a number.
fn least_of_the_close(aics: &[f64], deviations: &[f64]) -> Option<usize> {
    let most = (1.0 + EQUAL) * deviations.iter().copied().fold(f64::INFINITY, f64::min);
    least(aics, (0..aics.len()).filter(|k| deviations[*k] <= most))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::data;
    use crate::network::Method;
    use crate::testing::{closed_loop, multisine};
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
        let healthy = closed_loop(1500, 3, usize::MAX, 0.0);
        let select = |candidates: &[Structure], training: &Training| {
            let excited = [&data(&estimation), &data(&validation)];
            select_structure(candidates, excited, (&data(&healthy), 500), training)
        };
        let found = select(&candidates, &training).unwrap();
        let (rows, best) = (&found.rows, found.best);
        assert_eq!(rows.iter().map(|row| row.structure).collect::<Vec<_>>(), candidates);
        assert!(best > 0, "one neuron for a curve with a corner at zero");
        assert!(rows.iter().all(|row| row.trained.aic >= rows[best].trained.aic));
        let narrowest = rows.iter().map(|row| row.healthy).fold(f64::INFINITY, f64::min);
        assert!(rows[found.used].healthy <= (1.0 + EQUAL) * narrowest && narrowest > 0.0);
        assert_eq!(found.network(), &rows[found.used].trained);
        // A start that stops early leaves a large network worse than a small one, unless it begins
        // where that ended; whatever the order in which they are given.
        let quick = Limits { steps: 4, relative_decrease: 1e-6 };
        let method = Method::LevenbergMarquardt(quick);
        let hasty = Training { method, starts: 1, ..training };
        let mut grid = Structure::grid(1, 1);
        grid.reverse();
        let Selection { rows, .. } = select(&grid, &hasty).unwrap();
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
        assert_eq!(select(&[], &training).unwrap_err(), TrainingError::NoCandidate);
    }

    #[test]
    fn what_a_healthy_run_tells_apart_is_not_left_to_aic() {
        let aics = [-5000.0, -8000.0, -8500.0, -8900.0];
        assert_eq!(least_of_the_close(&aics, &[5.8, 6.0, 6.1, 18.0]), Some(2));
        assert_eq!(least_of_the_close(&aics, &[5.8, 6.0, 6.1, 6.2]), Some(3));
        // One that diverges is none, and of equals the first is taken.
        assert_eq!(least_of_the_close(&[-1.0, -1.0, -2.0], &[6.0, 6.0, f64::NAN]), Some(0));
        assert_eq!(least_of_the_close(&[-1.0], &[f64::NAN]), None);
    }
}
