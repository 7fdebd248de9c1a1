//! Linear least squares, min |X p - y|, by orthogonal triangularisation.
//!
//! The rows of [X | y] are gathered in blocks and folded into one triangular factor by
//! Householder reflections (sequential tall-skinny QR: Golub and Van Loan, "Matrix
//! Computations", 4th ed., 5.2; Demmel et al., SIAM J. Sci. Comput. 34, 2012). X^T X is never
//! formed, so that no digits are lost, the memory does not grow with the number of rows, and a
//! block stays in the fast cache. The factor of all columns also holds the answer for every
//! subset of columns over the same rows: a search over model orders costs one pass over the data.

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

/// Rows that are folded at once: a block of 41 columns then fits the first-level cache twice.
const BLOCK_ROWS: usize = 64;

/// Why a linear least-squares problem has no single answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RegressionError {
    /// Fewer equations than unknowns.
    #[error(
        "{unknowns} parameters need at least as many equations, there are {rows}: give more data or lower the orders"
    )]
    TooFewRows {
        /// Equations given.
        rows: usize,
        /// Parameters asked for.
        unknowns: usize,
    },
    /// The columns depend on each other: the data do not excite what is asked for.
    #[error(
        "the data determine only {rank} of {unknowns} parameters (regressor {column} depends on the others): lower the orders or excite the input more"
    )]
    RankDeficient {
        /// Independent columns.
        rank: usize,
        /// Parameters asked for.
        unknowns: usize,
        /// The first column found to depend on others, as the caller numbers them.
        column: usize,
    },
    /// A row held NaN or an infinity, or squares overflowed.
    #[error("equation values are not finite")]
    NotFinite,
}

/// Answer of a linear least-squares problem.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearFit {
    /// One value a column, in the order asked for.
    pub parameters: Vec<f64>,
    /// Sum of squared errors over all rows.
    pub sse: f64,
    /// Rows used.
    pub rows: usize,
}

/// A linear least-squares problem that is fed row by row; memory O(columns^2).
#[derive(Debug, Clone)]
pub struct Regression {
    columns: usize,
    rows: usize,
    /// Upper triangular factor of [X | y] seen so far.
    factor: DMatrix<f64>,
    /// Rows not yet folded, as columns of [X | y]: `block[(row, column)]`.
    block: DMatrix<f64>,
    filled: usize,
}

impl Regression {
    /// A problem of `columns` regressors without rows yet.
    pub fn new(columns: usize) -> Self {
        Self {
            columns,
            rows: 0,
            factor: DMatrix::zeros(columns + 1, columns + 1),
            block: DMatrix::zeros(BLOCK_ROWS, columns + 1),
            filled: 0,
        }
    }

    /// Adds the equation `regressors . p = target`.
    ///
    /// # Panics
    /// If there are not as many regressors as columns (an error of the calling code).
    pub fn push(&mut self, regressors: impl IntoIterator<Item = f64>, target: f64) {
        let mut given = 0;
        for (column, value) in regressors.into_iter().enumerate() {
            self.block[(self.filled, column)] = value;
            given += 1;
        }
        assert_eq!(given, self.columns, "one regressor a column");
        self.block[(self.filled, self.columns)] = target;
        self.filled += 1;
        self.rows += 1;
        if self.filled == BLOCK_ROWS {
            fold(&mut self.factor, &mut self.block, BLOCK_ROWS);
            self.filled = 0;
        }
    }

    /// Rows pushed so far.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The answer with all columns.
    pub fn solve(&self) -> Result<LinearFit, RegressionError> {
        self.solve_columns(&(0..self.columns).collect::<Vec<_>>())
    }

    /// The answer with these columns only, over the same rows: the others' parameters are zero.
    pub fn solve_columns(&self, chosen: &[usize]) -> Result<LinearFit, RegressionError> {
        let unknowns = chosen.len();
        if self.rows < unknowns {
            return Err(RegressionError::TooFewRows { rows: self.rows, unknowns });
        }
        let mut factor = self.factor.clone();
        fold(&mut factor, &mut self.block.clone(), self.filled);
        if factor.iter().any(|value| !value.is_finite()) {
            return Err(RegressionError::NotFinite);
        }
        // Columns scaled to length one: rank is then a matter of direction, not of units.
        let length: Vec<f64> = chosen.iter().map(|&c| factor.column(c).norm()).collect();
        let mut small = DMatrix::zeros(self.columns + 1, unknowns);
        for (k, &column) in chosen.iter().enumerate() {
            if length[k] > 0.0 {
                small.set_column(k, &(factor.column(column) / length[k]));
            }
        }
        let qr = small.col_piv_qr();
        let r = qr.r();
        let tolerance = f64::EPSILON * self.rows.max(unknowns) as f64;
        let rank = (0..unknowns).take_while(|&k| r[(k, k)].abs() > tolerance).count();
        if rank < unknowns {
            let mut order = DMatrix::from_fn(1, unknowns, |_, k| chosen[k]);
            qr.p().permute_columns(&mut order);
            let column = order[(0, rank)];
            return Err(RegressionError::RankDeficient { rank, unknowns, column });
        }
        let mut target = DVector::from(factor.column(self.columns));
        qr.q_tr_mul(&mut target);
        let sse = target.rows(unknowns, self.columns + 1 - unknowns).norm_squared();
        let mut scaled = DVector::from(target.rows(0, unknowns));
        // The diagonal was checked above: back substitution cannot meet a zero.
        let solved = r.view((0, 0), (unknowns, unknowns)).solve_upper_triangular_mut(&mut scaled);
        debug_assert!(solved);
        qr.p().inv_permute_rows(&mut scaled);
        let parameters = scaled.iter().zip(&length).map(|(p, length)| p / length).collect();
        Ok(LinearFit { parameters, sse, rows: self.rows })
    }
}

/// Folds the first `rows` rows of `block` into the triangular `factor`, column by column: the
/// reflection of column `j` involves the factor's diagonal entry and the block, nothing else.
fn fold(factor: &mut DMatrix<f64>, block: &mut DMatrix<f64>, rows: usize) {
    let columns = factor.ncols();
    let stride = block.nrows();
    let storage = block.as_mut_slice();
    for j in 0..columns {
        let (done, rest) = storage.split_at_mut((j + 1) * stride);
        let v = &mut done[j * stride..][..rows];
        let below = dot(v, v);
        if below == 0.0 {
            continue;
        }
        let diagonal = factor[(j, j)];
        let length = (diagonal * diagonal + below).sqrt();
        // The sign that adds, not cancels.
        let head = if diagonal < 0.0 { diagonal - length } else { diagonal + length };
        factor[(j, j)] = if diagonal < 0.0 { length } else { -length };
        let beta = 2.0 / (head * head + below);
        for (offset, column) in rest.chunks_exact_mut(stride).enumerate() {
            let k = j + 1 + offset;
            let column = &mut column[..rows];
            let scale = beta * (head * factor[(j, k)] + dot(v, column));
            factor[(j, k)] -= scale * head;
            for (c, v) in column.iter_mut().zip(v.iter()) {
                *c -= scale * v;
            }
        }
    }
}

/// Scalar product in eight partial sums, which the compiler keeps in vector registers.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut partial = [0.0; 8];
    let (a_head, a_tail) = a.as_chunks::<8>();
    let (b_head, b_tail) = b.as_chunks::<8>();
    for (a, b) in a_head.iter().zip(b_head) {
        for lane in 0..8 {
            partial[lane] += a[lane] * b[lane];
        }
    }
    let tail: f64 = a_tail.iter().zip(b_tail).map(|(a, b)| a * b).sum();
    partial.iter().sum::<f64>() + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few hundred roundings at condition numbers of order ten.
    const ROUNDING: f64 = 1e-12;

    fn wave(k: usize, j: usize) -> f64 {
        ((k * (j + 3)) as f64 * 0.37 + j as f64).sin()
    }

    /// Rows not a multiple of the block; errors that no column explains fully.
    fn problem(rows: usize, columns: usize) -> Regression {
        let mut regression = Regression::new(columns);
        for k in 0..rows {
            let target = (k as f64 * 0.91).cos() + 2.0 * wave(k, 0);
            regression.push((0..columns).map(|j| wave(k, j)), target);
        }
        regression
    }

    #[test]
    fn errors_are_orthogonal_to_the_columns_and_sum_to_sse() {
        let (rows, columns) = (333, 7);
        let fit = problem(rows, columns).solve().unwrap();
        let mut sse = 0.0;
        let mut along = vec![0.0; columns];
        for k in 0..rows {
            let model: f64 = (0..columns).map(|j| fit.parameters[j] * wave(k, j)).sum();
            let error = (k as f64 * 0.91).cos() + 2.0 * wave(k, 0) - model;
            sse += error * error;
            for (j, sum) in along.iter_mut().enumerate() {
                *sum += error * wave(k, j);
            }
        }
        assert!((sse - fit.sse).abs() < ROUNDING * sse, "{sse} against {}", fit.sse);
        assert!(along.iter().all(|a| a.abs() < rows as f64 * ROUNDING), "{along:?}");
    }

    #[test]
    fn a_subset_of_columns_equals_its_own_problem() {
        let chosen = [4, 0, 2];
        let whole = problem(200, 6).solve_columns(&chosen).unwrap();
        let mut own = Regression::new(3);
        for k in 0..200 {
            own.push(chosen.map(|j| wave(k, j)), (k as f64 * 0.91).cos() + 2.0 * wave(k, 0));
        }
        let own = own.solve().unwrap();
        assert!((whole.sse - own.sse).abs() < ROUNDING * own.sse);
        for (a, b) in whole.parameters.iter().zip(&own.parameters) {
            assert!((a - b).abs() < ROUNDING, "{a} against {b}");
        }
    }

    #[test]
    fn ill_conditioned_columns_keep_their_digits() {
        // cond(X) = 1e7 or so: the normal equations would keep two digits, QR keeps nine.
        let epsilon = 1e-7;
        let mut regression = Regression::new(2);
        for k in 0..50 {
            let (a, b) = (wave(k, 0), wave(k, 1));
            regression.push([a, a + epsilon * b], 3.0 * a + 2.0 * (a + epsilon * b));
        }
        let fit = regression.solve().unwrap();
        assert!((fit.parameters[0] - 3.0).abs() < 1e-7, "{:?}", fit.parameters);
        assert!((fit.parameters[1] - 2.0).abs() < 1e-7, "{:?}", fit.parameters);
    }

    #[test]
    fn units_do_not_decide_the_rank() {
        let mut regression = Regression::new(2);
        for k in 0..40 {
            regression.push([1e-12 * wave(k, 0), 1e12 * wave(k, 1)], wave(k, 0) + wave(k, 1));
        }
        let fit = regression.solve().unwrap();
        assert!((fit.parameters[0] * 1e-12 - 1.0).abs() < ROUNDING);
        assert!((fit.parameters[1] * 1e12 - 1.0).abs() < ROUNDING);
    }

    #[test]
    fn dependent_columns_are_named() {
        let mut regression = Regression::new(3);
        for k in 0..40 {
            regression.push([wave(k, 0), wave(k, 1), 2.0 * wave(k, 1)], 1.0);
        }
        match regression.solve() {
            Err(RegressionError::RankDeficient { rank: 2, unknowns: 3, column }) => {
                assert!(column == 1 || column == 2, "column {column} is independent");
            }
            other => panic!("{other:?}"),
        }
        assert!(regression.solve_columns(&[0, 2]).is_ok());
    }

    #[test]
    fn too_few_rows_and_nan_are_refused() {
        let too_few = problem(3, 4).solve();
        assert_eq!(too_few, Err(RegressionError::TooFewRows { rows: 3, unknowns: 4 }));
        let mut regression = problem(30, 2);
        regression.push([1.0, f64::NAN], 0.0);
        assert_eq!(regression.solve(), Err(RegressionError::NotFinite));
    }
}
