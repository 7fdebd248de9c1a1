//! The two linear programs of bounded-error estimation, by the simplex method of `microlp`.
//!
//! Coordinates are those of a [`Frame`](super::frame::Frame), where everything is of order one and
//! the solver's absolute tolerances mean relative ones.

use microlp::{ComparisonOp, Error, OptimizationDirection, Problem, SolveOptions, Variable};

use super::polytope::{HalfSpace, product};

/// Tightest feasibility tolerance that the solver offers.
const FEASIBLE: f64 = 1e-10;
/// Violation of an inequality that is not yet in the program, in the unit of the frame.
const VIOLATED: f64 = 1e-10;
/// Most violated inequalities that are added at once.
const ADDED: usize = 24;
/// Half width of the cube in which a smallest bound is searched: twice the proven one.
const CUBE: f64 = 4.0;

fn options() -> SolveOptions {
    let mut options = SolveOptions::default();
    options.tolerances.feasibility = FEASIBLE;
    // A dense program of a few dozen rows has nothing to presolve.
    options.presolve = false;
    options
}

/// max n . z over half-spaces; `None` if there is no maximum.
///
/// Solved through the dual, min h . lambda subject to sum_k lambda_k n_k = n and lambda >= 0: its
/// basis has as many rows as there are parameters, the primal's one a half-space.
pub(super) fn maximum(half_spaces: &[HalfSpace], normal: &[f64]) -> Option<f64> {
    let mut dual = Problem::new(OptimizationDirection::Minimize);
    let lambda: Vec<Variable> =
        half_spaces.iter().map(|row| dual.add_var(row.offset, (0.0, f64::INFINITY))).collect();
    for (j, n) in normal.iter().enumerate() {
        let row = lambda.iter().zip(half_spaces).map(|(lambda, row)| (*lambda, row.normal[j]));
        dual.add_constraint(row, ComparisonOp::Eq, *n);
    }
    let solution = dual.solve_with(options()).ok()?.into_solution().ok()?;
    Some(lambda.iter().zip(half_spaces).map(|(l, row)| solution.var_value(*l) * row.offset).sum())
}

/// The point z that lowers the largest violation of n_k . z <= h_k most, beside the half-spaces that
/// must hold, and that violation: min s subject to n_k . z - s <= h_k. Inequalities enter when they
/// are violated; at the end none is.
pub(super) fn least_violation(
    soft: &[HalfSpace],
    hard: &[HalfSpace],
    dimension: usize,
) -> Result<(Vec<f64>, f64), Error> {
    let mut inside: Vec<bool> = vec![false; soft.len()];
    let stride = soft.len().div_ceil(ADDED).max(1);
    inside.iter_mut().step_by(stride).for_each(|inside| *inside = true);
    loop {
        let mut problem = Problem::new(OptimizationDirection::Minimize);
        let z: Vec<Variable> =
            (0..dimension).map(|_| problem.add_var(0.0, (-CUBE, CUBE))).collect();
        let s = problem.add_var(1.0, (f64::NEG_INFINITY, f64::INFINITY));
        let rows = soft.iter().zip(&inside).filter(|(_, inside)| **inside);
        for HalfSpace { normal, offset } in rows.map(|(row, _)| row) {
            let row = z.iter().copied().zip(normal.iter().copied()).chain([(s, -1.0)]);
            problem.add_constraint(row, ComparisonOp::Le, *offset);
        }
        for HalfSpace { normal, offset } in hard {
            let row = z.iter().copied().zip(normal.iter().copied());
            problem.add_constraint(row, ComparisonOp::Le, *offset);
        }
        let outcome = problem.solve_with(options())?;
        let solution = outcome.into_solution().map_err(|_| Error::Infeasible)?;
        let at: Vec<f64> = z.iter().map(|z| solution.var_value(*z)).collect();
        let least = solution.var_value(s);
        let mut violated: Vec<(f64, usize)> = soft
            .iter()
            .enumerate()
            .map(|(k, row)| (product(&row.normal, &at) - row.offset - least, k))
            .filter(|(violation, k)| *violation > VIOLATED && !inside[*k])
            .collect();
        if violated.is_empty() {
            let worst = soft.iter().map(|row| product(&row.normal, &at) - row.offset);
            return Ok((at.clone(), worst.fold(f64::NEG_INFINITY, f64::max)));
        }
        violated.sort_by(|a, b| b.0.total_cmp(&a.0));
        violated.iter().take(ADDED).for_each(|(_, k)| inside[*k] = true);
    }
}

#[cfg(test)]
mod tests {
    use super::super::polytope::Polytope;
    use super::super::polytope::tests::random;
    use super::*;
    use crate::testing::noise;

    /// The bar: LP equals vertex enumeration.
    const BAR: f64 = 1e-9;

    #[test]
    fn maxima_equal_those_over_the_vertices() {
        for dimension in 1..=6 {
            let half_spaces = random(dimension, 40, 10 + dimension as u64);
            let mut polytope = Polytope::cube(dimension, 3.0);
            for half_space in &half_spaces[2 * dimension..] {
                polytope.cut(half_space.clone());
            }
            let facets = polytope.facets();
            assert!(facets.len() <= half_spaces.len());
            for seed in 0..20 {
                let normal = noise(dimension, 100 + seed);
                let by_vertices =
                    polytope.vertices().map(|z| product(&normal, z)).fold(f64::MIN, f64::max);
                for rows in [&half_spaces, &facets] {
                    let by_lp = maximum(rows, &normal).unwrap();
                    assert!((by_lp - by_vertices).abs() < BAR, "{by_lp} and {by_vertices}");
                }
            }
        }
        assert_eq!(maximum(&[], &[1.0]), None);
    }

    #[test]
    fn the_smallest_violation_is_the_chebyshev_distance() {
        // min over z of max |z - y_k| is half the range, whatever lies between.
        let y = noise(500, 1);
        let rows: Vec<HalfSpace> = y
            .iter()
            .flat_map(|y| [(1.0, *y), (-1.0, -*y)])
            .map(|(n, offset)| HalfSpace { normal: vec![n], offset })
            .collect();
        let (z, s) = least_violation(&rows, &[], 1).unwrap();
        let (low, high) = y.iter().fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(*y), h.max(*y)));
        assert!((s - 0.5 * (high - low)).abs() < BAR && (z[0] - 0.5 * (high + low)).abs() < BAR);
        let hard = [HalfSpace { normal: vec![1.0], offset: -0.5 }];
        let (z, s) = least_violation(&rows, &hard, 1).unwrap();
        assert!((z[0] + 0.5).abs() < BAR && (s - (high + 0.5)).abs() < BAR);
    }
}
