//! Linear least squares with the signs of physics and noise on the regressors.
//!
//! The normal equations of columns scaled to length one, less what the sensors' noise adds to
//! their diagonal (its variance is known, and noise is alike in no two columns). A column that
//! is nearly a combination of earlier ones is left out, one that comes out with the wrong sign is
//! zero and the others are solved again.

use nalgebra::{DMatrix, DVector};

/// Share of a column beside the earlier ones from which on it is told from them: squared sine of
/// the angle, 2 degrees.
const DISTINCT: f64 = 1e-3;
/// Most of a column's squares that may be taken for noise; beyond, the column is noise.
const MOST_NOISE: f64 = 0.5;

/// Normal equations gathered row by row.
#[derive(Debug, Clone)]
pub(super) struct Normal {
    gram: DMatrix<f64>,
    right: DVector<f64>,
    target: f64,
    rows: usize,
}

/// What a solution says.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    /// One value a column; none where the rows do not tell it. A value of the wrong sign is 0.
    pub(super) values: Vec<Option<f64>>,
    /// Standard error of each value, for independent rows.
    pub(super) errors: Vec<f64>,
    /// Sum of the squared errors of the balance.
    pub(super) sse: f64,
}

impl Normal {
    pub(super) fn new(columns: usize) -> Self {
        let (gram, right) = (DMatrix::zeros(columns, columns), DVector::zeros(columns));
        Self { gram, right, target: 0.0, rows: 0 }
    }

    /// Adds the equation `row . p = target`.
    pub(super) fn push(&mut self, row: &[f64], target: f64) {
        for (j, a) in row.iter().enumerate() {
            self.right[j] += a * target;
            for (k, b) in row.iter().enumerate().take(j + 1) {
                self.gram[(j, k)] += a * b;
            }
        }
        self.target += target * target;
        self.rows += 1;
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// The solution. `noise` is the variance of each column's noise; `signed` columns may be
    /// negative; an earlier column of `order` is preferred where columns are alike.
    pub(super) fn solve(&self, noise: &[f64], signed: &[bool], order: &[usize]) -> Solution {
        let columns = self.right.len();
        let mut gram = self.gram.clone();
        gram.fill_upper_triangle_with_lower_triangle();
        let clean = |k: &usize| {
            let added = noise[*k] * self.rows as f64;
            gram[(*k, *k)] > 0.0 && added <= MOST_NOISE * gram[(*k, *k)]
        };
        let usable: Vec<usize> = order.iter().copied().filter(clean).collect();
        for k in &usable {
            gram[(*k, *k)] -= noise[*k] * self.rows as f64;
        }
        let identified = distinct(&gram, &usable);
        let mut free = identified.clone();
        let solved = loop {
            let solved = self.over(&gram, &free);
            let wrong =
                free.iter().zip(solved.iter()).filter(|(k, value)| !signed[**k] && **value < 0.0);
            // In units of what a column moves.
            let worst = wrong.min_by(|a, b| {
                let size = |(k, value): &(&usize, &f64)| **value * gram[(**k, **k)].sqrt();
                size(a).total_cmp(&size(b))
            });
            match worst.map(|(k, _)| *k) {
                Some(k) => free.retain(|other| *other != k),
                None => break solved,
            }
        };
        let mut values: Vec<Option<f64>> = vec![None; columns];
        identified.iter().for_each(|k| values[*k] = Some(0.0));
        free.iter().zip(solved.iter()).for_each(|(k, value)| values[*k] = Some(*value));
        let p = DVector::from_fn(columns, |k, _| values[k].unwrap_or(0.0));
        let mut whole = self.gram.clone();
        whole.fill_upper_triangle_with_lower_triangle();
        let sse = (self.target - 2.0 * p.dot(&self.right) + p.dot(&(whole * &p))).max(0.0);
        let errors = self.errors(&gram, &free, sse);
        Solution { values, errors, sse }
    }

    fn over(&self, gram: &DMatrix<f64>, free: &[usize]) -> DVector<f64> {
        let size = |k: usize| gram[(k, k)].sqrt();
        let scaled = DMatrix::from_fn(free.len(), free.len(), |a, b| {
            gram[(free[a], free[b])] / (size(free[a]) * size(free[b]))
        });
        let right = DVector::from_fn(free.len(), |a, _| self.right[free[a]] / size(free[a]));
        let solved = solved(scaled, &right).unwrap_or_else(|| DVector::zeros(free.len()));
        DVector::from_fn(free.len(), |a, _| solved[a] / size(free[a]))
    }

    fn errors(&self, gram: &DMatrix<f64>, free: &[usize], sse: f64) -> Vec<f64> {
        let mut errors = vec![0.0; self.right.len()];
        let some = gram.select_rows(free).select_columns(free);
        let variance = sse / self.rows.saturating_sub(free.len()).max(1) as f64;
        if let Some(inverse) = (!free.is_empty()).then(|| some.try_inverse()).flatten() {
            for (a, k) in free.iter().enumerate() {
                errors[*k] = (variance * inverse[(a, a)]).max(0.0).sqrt();
            }
        }
        errors
    }
}

/// The solution of a square system; none if it is singular, or has no unknowns.
fn solved(matrix: DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    (!right.is_empty()).then(|| matrix.lu().solve(right))?
}

/// The columns that are told from those before them.
fn distinct(gram: &DMatrix<f64>, order: &[usize]) -> Vec<usize> {
    let mut taken: Vec<usize> = Vec::new();
    for k in order {
        let onto = DVector::from_fn(taken.len(), |a, _| gram[(taken[a], *k)]);
        let some = gram.select_rows(&taken).select_columns(&taken);
        let explained = solved(some, &onto).map_or(0.0, |weights| weights.dot(&onto));
        if gram[(*k, *k)] - explained > DISTINCT * gram[(*k, *k)] {
            taken.push(*k);
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gaussian;

    const ROWS: usize = 20_000;

    #[test]
    fn noise_on_a_regressor_takes_nothing_away() {
        let (truth, noise, other) = (gaussian(ROWS, 1), gaussian(ROWS, 2), gaussian(ROWS, 3));
        let mut normal = Normal::new(2);
        for k in 0..ROWS {
            normal.push(&[truth[k] + 0.5 * noise[k], other[k]], 3.0 * truth[k] + 2.0 * other[k]);
        }
        let plain = normal.solve(&[0.0, 0.0], &[false; 2], &[0, 1]);
        let right = normal.solve(&[0.25, 0.0], &[false; 2], &[0, 1]);
        let first = |solution: &Solution| solution.values[0].expect("told");
        assert!((first(&plain) - 2.4).abs() < 0.05, "{plain:?}");
        assert!((first(&right) - 3.0).abs() < 0.05, "{right:?}");
        let drowned = normal.solve(&[0.7, 0.0], &[false; 2], &[0, 1]);
        assert_eq!(drowned.values[0], None, "more than half of it is noise");
    }

    #[test]
    fn a_wrong_sign_is_zero_and_what_is_alike_is_left_out() {
        let (a, b) = (gaussian(500, 1), gaussian(500, 2));
        let mut normal = Normal::new(3);
        for k in 0..500 {
            normal.push(&[a[k], b[k], 2.0 * a[k] + 1e-3 * b[k]], 3.0 * a[k] - 0.5 * b[k]);
        }
        let found = normal.solve(&[0.0; 3], &[false; 3], &[0, 1, 2]);
        assert_eq!((found.values[1], found.values[2]), (Some(0.0), None));
        assert!((found.values[0].expect("told") - 3.0).abs() < 0.1, "{found:?}");
        let signed = normal.solve(&[0.0; 3], &[false, true, false], &[2, 1, 0]);
        assert_eq!(signed.values[0], None);
        assert!((signed.values[1].expect("told") + 0.5).abs() < 0.01, "{signed:?}");
        assert!(signed.sse < 1e-6 && signed.errors[1] < 1e-4, "{signed:?}");
    }
}
