//! Adaptive Random Search, the training that the paper used.
//!
//! Each outer step explores the standard deviation, sigma_i = sigma_0 10^-(i-1) with 100 / i
//! trials each, i = 1..5, all from the best point so far, then exploits the one that did best with
//! 100 more trials. Source: E. Walter and L. Pronzato, "Identification of Parametric Models from
//! Experimental Data", Springer 1997, Section 4.3.9; v_0 = 0.1 is read as sigma_0^2.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// sigma_0^2.
const FIRST_VARIANCE: f64 = 0.1;
/// Standard deviations explored, each a tenth of the one before.
const SCALES: i32 = 5;
/// Trials at the first standard deviation and in exploitation.
const TRIALS: i32 = 100;

/// Best point found within `outer` steps from `start`, and its cost.
pub(super) fn search(
    cost: impl Fn(&[f64]) -> f64,
    start: Vec<f64>,
    outer: usize,
    random: &mut impl Rng,
) -> (Vec<f64>, f64) {
    let mut best_cost = cost(&start);
    let mut best = start;
    for _ in 0..outer {
        let (mut chosen, mut lowest) = (1, f64::INFINITY);
        let (from, from_cost) = (best.clone(), best_cost);
        for i in 1..=SCALES {
            let (point, reached) =
                trials(&cost, (from.clone(), from_cost), deviation(i), TRIALS / i, random);
            if reached < lowest {
                (chosen, lowest) = (i, reached);
            }
            if reached < best_cost {
                (best, best_cost) = (point, reached);
            }
        }
        (best, best_cost) = trials(&cost, (best, best_cost), deviation(chosen), TRIALS, random);
    }
    (best, best_cost)
}

fn deviation(i: i32) -> f64 {
    FIRST_VARIANCE.sqrt() * 10_f64.powi(1 - i)
}

/// Normal steps from a point that moves whenever one lowers the cost.
fn trials(
    cost: &impl Fn(&[f64]) -> f64,
    (mut best, mut best_cost): (Vec<f64>, f64),
    deviation: f64,
    count: i32,
    random: &mut impl Rng,
) -> (Vec<f64>, f64) {
    for _ in 0..count {
        let trial: Vec<f64> = best
            .iter()
            .map(|p| p + deviation * Distribution::<f64>::sample(&StandardNormal, random))
            .collect();
        let reached = cost(&trial);
        if reached < best_cost || best_cost.is_nan() {
            (best, best_cost) = (trial, reached);
        }
    }
    (best, best_cost)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    use super::*;

    #[test]
    fn a_bowl_is_descended_in_the_trials_that_the_book_counts() {
        let evaluations = Cell::new(0);
        let cost = |p: &[f64]| {
            evaluations.set(evaluations.get() + 1);
            p.iter().enumerate().map(|(i, x)| (x - i as f64).powi(2)).sum()
        };
        let start = vec![3.0; 4];
        let (found, reached) = search(cost, start, 20, &mut Pcg64::seed_from_u64(1));
        assert_eq!(evaluations.get(), 1 + 20 * (100 + 50 + 33 + 25 + 20 + 100));
        assert!(reached < 1e-4, "{found:?} with {reached}");
        let again = search(
            |p: &[f64]| p.iter().enumerate().map(|(i, x)| (x - i as f64).powi(2)).sum(),
            vec![3.0; 4],
            20,
            &mut Pcg64::seed_from_u64(1),
        );
        assert_eq!((found, reached), again);
    }
}
