//! ARX orders by the error of the free run on data that were not fitted.
//!
//! AIC weighs one-step errors, but bands rest on the free run: there a slow pole that one-step
//! prediction hardly feels drifts away. A candidate counts only if five of its own time constants,
//! in which it settles, leave at least half of the data to judge it by.

use std::sync::Arc;

use super::fit::{equations, fit_columns};
use super::{Arx, ArxError, Orders};
use crate::data::Data;
use crate::model::Model;
use crate::signal_model::{Start, residual};
use crate::threshold::mean_and_deviation;

/// Orders that are tried of the past outputs; 0 is a finite impulse response.
const TRIED: [usize; 10] = [0, 1, 2, 3, 4, 6, 8, 10, 14, 20];
/// What a larger model must lower the error by, as a share, to be preferred to a smaller one.
pub(crate) const WORTH: f64 = 0.05;

/// One candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeRunRow {
    pub orders: Orders,
    /// Samples in which it settles: five of its slowest time constants.
    pub run_up: usize,
    /// Standard deviation of its free-run error on the data that judge, output unit.
    pub deviation: f64,
}

/// The candidates that could be judged, and the best of them.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeRunOrders {
    /// The candidates, n_a outside, n_b inside.
    pub rows: Vec<FreeRunRow>,
    /// The one that was chosen.
    pub best: FreeRunRow,
    pub model: Arc<Arx>,
}

/// What is left of a recording after a run-up at the start of every segment.
pub(crate) fn left_after(data: &Data, run_up: usize) -> usize {
    data.segments().iter().map(|segment| segment.len().saturating_sub(run_up)).sum()
}

/// Whether a run-up leaves half of a recording or more.
pub(crate) fn leaves_half(data: &Data, run_up: usize) -> bool {
    2 * left_after(data, run_up) >= left_after(data, 0).max(4)
}

/// The longest run-up that leaves half of each of some recordings.
pub(crate) fn longest_run_up(of: &[&Data]) -> usize {
    let leaves = |run_up: usize| of.iter().all(|data| leaves_half(data, run_up));
    let most = of.iter().map(|data| data.len()).max().unwrap_or(0);
    let (mut leaving, mut too_long) = (0, most + 1);
    while too_long - leaving > 1 {
        let middle = leaving.midpoint(too_long);
        if leaves(middle) { leaving = middle } else { too_long = middle }
    }
    leaving
}

impl Arx {
    /// Fits orders up to `widest` on `fitted` data, two thirds of `healthy`, and takes the smallest of
    /// those whose free-run error on the last third is within a twentieth of the best.
    pub fn select_by_free_run(
        healthy: &Data,
        widest: Orders,
        start: Start,
    ) -> Result<FreeRunOrders, ArxError> {
        let cut = healthy.len() * 2 / 3;
        let (fitted, judged) = (healthy.span(0..cut), healthy.span(cut..healthy.len()));
        let equations = equations(&fitted, widest)?;
        let inputs = healthy.inputs().len();
        let up_to = |most: usize, least: usize| {
            TRIED.into_iter().filter(move |order| (least..=most).contains(order))
        };
        let grid =
            up_to(widest.n_a, 0).flat_map(|n_a| up_to(widest.n_b, 1).map(move |n_b| (n_a, n_b)));
        let mut candidates = Vec::new();
        let mut last = ArxError::Unstable { n_a: widest.n_a, n_b: widest.n_b };
        for (n_a, n_b) in grid {
            let orders = Orders { n_a, n_b, constant: widest.constant };
            let model = match fit_columns(&equations, inputs, widest, orders) {
                Ok(fit) => fit.model,
                Err(error) => {
                    last = error;
                    continue;
                }
            };
            let run_up = Model::Arx(Arc::clone(&model)).run_up();
            if !leaves_half(&judged, run_up) {
                continue;
            }
            let remainder = residual(&mut model.run(), &judged, start);
            let (_, deviation) = mean_and_deviation(&judged.judged(&remainder, run_up));
            candidates.push((FreeRunRow { orders, run_up, deviation }, model));
        }
        let tried = candidates.iter().map(|(row, _)| row.deviation).filter(|it| it.is_finite());
        let least = tried.fold(f64::INFINITY, f64::min);
        let close = candidates.iter().filter(|(row, _)| row.deviation <= (1.0 + WORTH) * least);
        let best = close.min_by_key(|(row, _)| row.orders.parameters(inputs)).cloned();
        let Some((best, model)) = best else {
            return Err(ArxError::NoOrder {
                candidates: TRIED.len() * TRIED.len(),
                n_a: widest.n_a,
                n_b: widest.n_b,
                last: Box::new(last),
            });
        };
        let rows = candidates.into_iter().map(|(row, _)| row).collect();
        Ok(FreeRunOrders { rows, best, model })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;
    use crate::testing::noise;

    const WIDEST: Orders = Orders { n_a: 20, n_b: 20, constant: true };

    /// A lag of ten samples under coloured noise of the output and a slow drift that no input makes.
    fn drifting(samples: usize, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let (u, e) = (noise(samples, seed), noise(samples, seed + 100));
        let (mut x, mut d, mut y) = (0.0, 0.0, Vec::new());
        for k in 0..samples {
            d = 0.999 * d + 0.02 * e[k];
            y.push(x + d + 0.1 * e[(k * 7) % samples]);
            x = 0.9 * x + u[k];
        }
        (u, y)
    }

    #[test]
    fn a_slow_pole_of_the_noise_is_not_taken_for_the_model() {
        let (u, y) = drifting(3000, 1);
        let input = vec![Column { name: "u", values: &u }];
        let data = Data::new(input, Column { name: "y", values: &y }).expect("finite");
        let found = Arx::select_by_free_run(&data, WIDEST, Start::Steady).expect("it is one");
        // No candidate is much better, the fastest and smallest of the equals is taken, and none is
        // slower than half of what judges it.
        let not_worse = |row: &FreeRunRow| found.best.deviation <= (1.0 + WORTH) * row.deviation;
        assert!(found.rows.iter().all(not_worse), "{:?}", found.best);
        assert!(found.best.orders.parameters(1) < WIDEST.parameters(1), "{:?}", found.best);
        assert!(found.rows.iter().all(|row| row.run_up <= 500));
        let smaller =
            |row: &&FreeRunRow| row.orders.parameters(1) < found.best.orders.parameters(1);
        let least = found.rows.iter().map(|row| row.deviation).fold(f64::INFINITY, f64::min);
        let good = |row: &FreeRunRow| row.deviation <= (1.0 + WORTH) * least;
        assert!(!found.rows.iter().filter(smaller).any(good));
    }

    #[test]
    fn what_settles_too_slowly_for_the_data_is_no_candidate() {
        let (u, y) = drifting(3000, 2);
        let input = vec![Column { name: "u", values: &u }];
        let data = Data::new(input, Column { name: "y", values: &y }).expect("finite");
        // Segments of 80 samples: nothing slower than 8 samples can be judged.
        let data = data.in_segments((0..37).map(|k| 80 * k..80 * (k + 1)).collect());
        let found = Arx::select_by_free_run(&data, WIDEST, Start::Steady).expect("it is one");
        assert!(found.rows.iter().all(|row| row.run_up <= 40), "{:?}", found.rows);
        assert_eq!(longest_run_up(&[&data]), 40);
    }
}
