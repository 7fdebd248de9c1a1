//! The test of a shape: whether it explains more than chance does.
//!
//! The shape's columns are made orthogonal to the base's, and an orthonormal basis O of what is
//! left is taken: beta = O' e. The score of block b is s_b = sum of O_row (e - O beta)_row over its
//! rows, from the residual after the shape was removed. A shape that lives in a few blocks fits
//! their noise, and would leave them too little: with M_b = sum of O_row O_row' the score counts
//! as (1 - M_b)^-1/2 s_b, which has the right variance (Bell and McCaffrey, 2002). Then V = sum
//! s_b s_b' and W = beta' V^-1 beta, divided by k (G - 1) / (G - k), is compared with F(k, G - k) for k columns and G blocks
//! (Hotelling, 1931): few blocks know their variance badly, and the law of F knows that.
//!
//! A shape of which a few blocks hold most knows it worse than that law says. Where the residual is
//! white, its own variance is the better judge: beta' beta over it, divided by k, is F(k, n - k) for n
//! rows. The greater probability of the two counts: the blocks guard against what is not white, the
//! rows against shapes that live in few blocks.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// A direction is left out if less than this share of its squared length is outside the base:
/// below it, derivatives that are exact to some 1e-4 tell nothing.
const OUTSIDE: f64 = 1e-4;
/// A column of the base is left out if less than this share of its length is new.
const NEW: f64 = 1e-5;

/// Share of a direction outside a block below which it is in that block alone.
const ALONE: f64 = 1e-3;

/// What a shape explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Score {
    /// Squared error that it takes away.
    pub(super) gain: f64,
    /// Its independent columns.
    pub(super) columns: usize,
    /// Mean variance of a coefficient, by blocks: 1 for white noise.
    pub(super) variance: f64,
    /// Probability of as much by chance.
    pub(super) p_value: f64,
}

/// An orthonormal basis of these columns.
pub(super) fn basis<'a>(columns: impl Iterator<Item = &'a [f64]>, rows: usize) -> DMatrix<f64> {
    let mut kept: Vec<DVector<f64>> = Vec::new();
    for column in columns {
        let mut remainder = DVector::from_column_slice(column);
        let size = remainder.norm();
        // Twice is enough (Kahan and Parlett).
        for _ in 0..2 {
            for q in &kept {
                let along = q.dot(&remainder);
                remainder.axpy(-along, q, 1.0);
            }
        }
        let new = remainder.norm();
        if new > NEW * size {
            kept.push(remainder / new);
        }
    }
    if kept.is_empty() { DMatrix::zeros(rows, 0) } else { DMatrix::from_columns(&kept) }
}

/// What is left of a column outside the basis.
pub(super) fn outside(basis: &DMatrix<f64>, column: &[f64]) -> DVector<f64> {
    let column = DVector::from_column_slice(column);
    let along = basis.tr_mul(&column);
    column - basis * along
}

/// An orthonormal basis of what is left of a shape's columns outside the base; none if that is
/// nothing.
pub(super) fn own_basis(base: &DMatrix<f64>, columns: &[Vec<f64>]) -> Option<DMatrix<f64>> {
    let sized: Vec<DVector<f64>> = columns
        .iter()
        .map(|column| DVector::from_column_slice(column))
        .filter_map(|column| column.try_normalize(0.0))
        .collect();
    if sized.is_empty() {
        return None;
    }
    let sized = DMatrix::from_columns(&sized);
    let along = base.transpose() * &sized;
    let remainder = sized - base * along;
    let eigen = SymmetricEigen::new(remainder.transpose() * &remainder);
    let kept: Vec<DVector<f64>> = (0..eigen.eigenvalues.len())
        .filter(|k| eigen.eigenvalues[*k] > OUTSIDE)
        .map(|k| &remainder * eigen.eigenvectors.column(k) / eigen.eigenvalues[k].sqrt())
        .collect();
    if kept.is_empty() { None } else { Some(DMatrix::from_columns(&kept)) }
}

/// A residual through a filter, beside columns that are known.
pub(super) struct Filtered<'a> {
    filter: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
    /// A basis of the known columns through the filter.
    known: DMatrix<f64>,
    /// What they leave of the residual.
    remainder: DVector<f64>,
}

impl<'a> Filtered<'a> {
    pub(super) fn new<'b>(
        residual: &[f64],
        known: impl Iterator<Item = &'b [f64]>,
        filter: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
    ) -> Self {
        let known: Vec<Vec<f64>> = known.map(filter).collect();
        let residual = filter(residual);
        let known = basis(known.iter().map(Vec::as_slice), residual.len());
        let remainder = outside(&known, &residual);
        Self { filter, known, remainder }
    }

    /// The test of a shape's columns, with the block of each row; none if the known ones leave nothing of
    /// them.
    pub(super) fn score(
        &self,
        columns: &[Vec<f64>],
        (blocks, count): &(Vec<usize>, usize),
    ) -> Option<Score> {
        let columns: Vec<Vec<f64>> = columns.iter().map(|it| (self.filter)(it)).collect();
        Some(score(&own_basis(&self.known, &columns)?, &self.remainder, (blocks, *count)))
    }
}

/// The test of the basis `own` on the residual `e`, with the block of each row.
pub(super) fn score(own: &DMatrix<f64>, e: &DVector<f64>, blocks: (&[usize], usize)) -> Score {
    let k = own.ncols();
    let beta = own.tr_mul(e);
    let remainder = e - own * &beta;
    let mut scores = DMatrix::<f64>::zeros(k, blocks.1);
    let mut shares = vec![DMatrix::<f64>::zeros(k, k); blocks.1];
    // A row of the basis beside the other: the sums over a block are gone through row by row.
    let rows = own.transpose();
    for ((row, left), block) in rows.column_iter().zip(&remainder).zip(blocks.0) {
        scores.column_mut(*block).axpy(*left, &row, 1.0);
        shares[*block].ger(1.0, &row, &row, 1.0);
    }
    let variance = scores.norm_squared() / k as f64;
    let gain = beta.norm_squared();
    for (mut score, share) in scores.column_iter_mut().zip(shares) {
        let eigen = SymmetricEigen::new(share);
        if eigen.eigenvalues.iter().any(|share| 1.0 - share < ALONE) {
            // A direction that is in one block alone has no variance to be judged by.
            return Score { gain, columns: k, variance, p_value: 1.0 };
        }
        let mut rotated = eigen.eigenvectors.tr_mul(&score);
        for (value, share) in rotated.iter_mut().zip(eigen.eigenvalues.iter()) {
            *value /= (1.0 - share).sqrt();
        }
        score.copy_from(&(eigen.eigenvectors * rotated));
    }
    let v = &scores * scores.transpose();
    let w = v.cholesky().map_or(0.0, |it| beta.dot(&it.solve(&beta)));
    let (g, k_f) = (blocks.1 as f64, k as f64);
    let by_blocks = chance(w * (g - k_f) / (k_f * (g - 1.0)), k_f, g - k_f);
    let left = remainder.iter().filter(|it| **it != 0.0).count() as f64 - k_f;
    let by_rows = chance(gain / k_f / (remainder.norm_squared() / left), k_f, left);
    Score { gain, columns: k, variance, p_value: by_blocks.max(by_rows) }
}

/// Probability of a greater value under F with those degrees of freedom; 1 where there are too few, so
/// that nothing can be said.
fn chance(f: f64, numerator: f64, denominator: f64) -> f64 {
    match FisherSnedecor::new(numerator, denominator) {
        Ok(law) if f.is_finite() && f > 0.0 => law.sf(f),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gaussian;

    const ROWS: usize = 2000;
    const BLOCKS: usize = 40;

    fn blocks() -> Vec<usize> {
        (0..ROWS).map(|row| row * BLOCKS / ROWS).collect()
    }

    /// Slow noise: an autoregression with a memory of some 10 rows.
    fn slow(seed: u64) -> Vec<f64> {
        let mut x = 0.0;
        let draws = gaussian(ROWS, seed);
        draws
            .into_iter()
            .map(|w| {
                x = 0.9 * x + w;
                x
            })
            .collect()
    }

    fn shape(seed: u64) -> Vec<Vec<f64>> {
        (0..3).map(|j| slow(1000 + 10 * seed + j)).collect()
    }

    #[test]
    fn chance_is_found_as_often_as_stated_in_coloured_noise() {
        const RUNS: usize = 600;
        let none = DMatrix::zeros(ROWS, 0);
        let blocks = blocks();
        let below = |limit: f64| {
            let hits = (0..RUNS).filter(|run| {
                let own = own_basis(&none, &shape(*run as u64)).expect("there are columns");
                let e = DVector::from_vec(slow(*run as u64));
                score(&own, &e, (&blocks, BLOCKS)).p_value < limit
            });
            hits.count() as f64 / RUNS as f64
        };
        // 600 runs know 5 % to +-0.9 %. Blocks of five correlation times leave up to twice the
        // stated rate in noise that was not whitened; a comparison whitens first.
        let found = below(0.05);
        assert!((0.015..0.10).contains(&found), "{found}");
    }

    #[test]
    fn a_shape_that_lives_in_few_blocks_is_found_in_white_noise_as_often_as_stated() {
        const RUNS: u64 = 2000;
        // Hats over the time, three blocks each: by the blocks alone 3 % are below 0.1 %.
        let hat = |j: usize, row: usize| {
            (1.0 - (8.0 * row as f64 / ROWS as f64 - j as f64).abs()).max(0.0)
        };
        let columns: Vec<Vec<f64>> =
            (0..9).map(|j| (0..ROWS).map(|row| hat(j, row)).collect()).collect();
        let own = own_basis(&DMatrix::zeros(ROWS, 0), &columns).expect("there are columns");
        let few: Vec<usize> = (0..ROWS).map(|row| row * 25 / ROWS).collect();
        let hits = (0..RUNS).filter(|run| {
            let e = DVector::from_vec(gaussian(ROWS, 10_000 + run));
            score(&own, &e, (&few, 25)).p_value < 1e-3
        });
        // 2 are expected; more than 8 come by chance in one of ten thousand such tests.
        let hits = hits.count();
        assert!(hits <= 8, "{hits} of {RUNS}");
    }

    #[test]
    fn what_lives_in_one_block_is_not_judged() {
        let column: Vec<f64> = (0..ROWS).map(|row| f64::from(u8::from(row < 10))).collect();
        let own = own_basis(&DMatrix::zeros(ROWS, 0), std::slice::from_ref(&column));
        let own = own.expect("there is a column");
        let noise = gaussian(ROWS, 5);
        let e = noise.iter().zip(&column).map(|(n, c)| n + 9.0 * c);
        let found = score(&own, &DVector::from_iterator(ROWS, e), (&blocks(), BLOCKS));
        assert_eq!((found.p_value, found.columns), (1.0, 1));
    }

    #[test]
    fn what_is_there_is_found_and_what_the_base_has_is_not() {
        let columns = shape(7);
        let blocks = blocks();
        let noise = slow(3);
        let e: Vec<f64> = noise.iter().zip(&columns[1]).map(|(n, c)| n + 0.8 * c).collect();
        let none = DMatrix::zeros(ROWS, 0);
        let own = own_basis(&none, &columns).expect("there are columns");
        let found = score(&own, &DVector::from_column_slice(&e), (&blocks, BLOCKS));
        assert!(found.p_value < 1e-4, "{found:?}");
        assert_eq!(found.columns, 3);
        // The same columns in the base: nothing of the shape is left.
        let base = basis(columns.iter().map(Vec::as_slice), ROWS);
        assert!(own_basis(&base, &columns).is_none());
        assert!(outside(&base, &columns[0]).norm() < 1e-9);
    }
}
