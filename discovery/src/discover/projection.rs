//! What a few columns explain of a residual beside the base: linear least squares with the base
//! taken out, and a test that holds for coloured disturbances.
//!
//! With B the base columns and C those of a candidate, C_perp = C - C B^T (B B^T)^-1 B; the
//! coefficients are c = S^-1 C_perp r, S = C_perp C_perp^T, and the gain (the squared error that
//! goes) c^T S c. The Wald statistic takes the covariance of c from what blocks of time add to
//! the score with the residual left after the candidate, so that a slow disturbance does not
//! count as many independent values.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::columns::Place;

/// Share of a column's squared length that must stand out of the base for it to be judged;
/// below, it is equal to the base by algebra, to what the derivatives are accurate to.
pub(crate) const STANDS_OUT: f64 = 1e-6;
/// Relative size below which a direction of the base is nothing but rounding.
const ROUNDING: f64 = 1e-11;
/// Blocks beyond the number of coefficients that the test needs.
const FEWEST_BLOCKS: usize = 6;

/// Base columns with their inverse Gram matrix, and the residual without them.
#[derive(Debug, Clone)]
pub(crate) struct Projection {
    base: DMatrix<f64>,
    inverse: DMatrix<f64>,
    step: DVector<f64>,
    residual: DVector<f64>,
}

/// Products of some columns with themselves and the residual, the base taken out.
#[derive(Debug, Clone)]
pub(crate) struct Products {
    /// C_perp C_perp^T.
    pub(crate) information: DMatrix<f64>,
    /// Squared length of each column with the base in it.
    pub(crate) whole: Vec<f64>,
    /// C_perp r.
    pub(crate) score: DVector<f64>,
}

/// What some columns explain.
#[derive(Debug, Clone)]
pub(crate) struct Explained {
    /// One coefficient a column.
    pub(crate) coefficients: DVector<f64>,
    /// Squared error that goes.
    pub(crate) gain: f64,
    /// Columns that are independent of each other and of the base.
    pub(crate) rank: usize,
    /// Share of each column's squared length that stands out of the base.
    pub(crate) stands_out: Vec<f64>,
}

impl Projection {
    /// Of these base columns and residual.
    pub(crate) fn new(base: DMatrix<f64>, residual: &[f64]) -> Self {
        let inverse = pseudo_inverse(&(&base * base.transpose()));
        let r = DVector::from_column_slice(residual);
        let step = &inverse * (&base * &r);
        let residual = &r - base.tr_mul(&step);
        Self { base, inverse, step, residual }
    }

    /// By how much the base moves to take away what it can.
    pub(crate) fn step(&self) -> &DVector<f64> {
        &self.step
    }

    /// The residual without the base.
    pub(crate) fn residual(&self) -> &DVector<f64> {
        &self.residual
    }

    /// Squared error that goes where the residual becomes this one and the base moves beside it.
    pub(crate) fn gain(&self, residual: &[f64]) -> f64 {
        let residual = DVector::from_column_slice(residual);
        let score = &self.base * &residual;
        self.residual.norm_squared() - residual.norm_squared()
            + score.dot(&(&self.inverse * &score))
    }

    /// What the columns explain beside the base.
    pub(crate) fn explain(&self, columns: &DMatrix<f64>) -> Explained {
        let Products { information, whole, score } = self.products(columns);
        let stands_out = (0..columns.nrows())
            .map(|k| if whole[k] > 0.0 { information[(k, k)] / whole[k] } else { 0.0 })
            .collect();
        let rank = rank(&information, &whole);
        let coefficients = pseudo_inverse(&information) * &score;
        let gain = coefficients.dot(&score).max(0.0);
        Explained { coefficients, gain, rank, stands_out }
    }

    /// Information and score of the columns beside the base, in one run over the values: columns
    /// are few and values are many.
    pub(crate) fn products(&self, columns: &DMatrix<f64>) -> Products {
        let (rows, bases) = (columns.nrows(), self.base.nrows());
        let width = bases + rows + 1;
        let mut side = vec![0.0; width];
        let mut sums = vec![0.0; rows * width];
        for (value, residual) in self.residual.iter().enumerate() {
            let own = &columns.as_slice()[value * rows..(value + 1) * rows];
            side[..bases]
                .copy_from_slice(&self.base.as_slice()[value * bases..(value + 1) * bases]);
            side[bases..bases + rows].copy_from_slice(own);
            side[width - 1] = *residual;
            for (factor, sums) in own.iter().zip(sums.chunks_exact_mut(width)) {
                for (sum, side) in sums.iter_mut().zip(&side) {
                    *sum += factor * side;
                }
            }
        }
        let cross = DMatrix::from_fn(rows, bases, |row, k| sums[row * width + k]);
        let product = DMatrix::from_fn(rows, rows, |row, k| sums[row * width + bases + k]);
        Products {
            whole: (0..rows).map(|k| product[(k, k)]).collect(),
            information: product - &cross * &self.inverse * cross.transpose(),
            score: DVector::from_fn(rows, |row, _| sums[row * width + width - 1]),
        }
    }

    /// What the columns with those coefficients change beside the base.
    pub(crate) fn change(
        &self,
        columns: &DMatrix<f64>,
        coefficients: &DVector<f64>,
    ) -> DVector<f64> {
        let change = columns.tr_mul(coefficients);
        let shift = &self.inverse * (&self.base * &change);
        change - self.base.tr_mul(&shift)
    }

    /// By how much the base moves where the columns take these coefficients.
    pub(crate) fn shift(
        &self,
        columns: &DMatrix<f64>,
        coefficients: &DVector<f64>,
    ) -> DVector<f64> {
        -(&self.inverse * (&self.base * columns.tr_mul(coefficients)))
    }
}

/// The block-robust Wald test of coefficients, by Hotelling's correction for few blocks; `freedom`
/// is the number of parameters that were chosen for the gain.
#[allow(clippy::too_many_arguments)]
pub(crate) fn wald(
    beside: &DMatrix<f64>,
    after: &DVector<f64>,
    information: &DMatrix<f64>,
    coefficients: &DVector<f64>,
    freedom: usize,
    places: &[Place],
    block: impl Fn(&Place) -> usize,
) -> f64 {
    let k = coefficients.len();
    let mut scores: Vec<DVector<f64>> = Vec::new();
    let mut last = usize::MAX;
    for (value, place) in places.iter().enumerate() {
        let now = block(place);
        if now != last || scores.is_empty() {
            scores.push(DVector::zeros(k));
            last = now;
        }
        if let Some(score) = scores.last_mut() {
            score.axpy(after[value], &beside.column(value), 1.0);
        }
    }
    scores.retain(|score| score.iter().any(|value| *value != 0.0));
    let blocks = scores.len();
    if freedom == 0 || blocks < freedom + FEWEST_BLOCKS {
        return 1.0;
    }
    let mut middle = DMatrix::zeros(k, k);
    for score in &scores {
        middle.ger(1.0, score, score, 1.0);
    }
    // White noise alone gives at least the information itself.
    let pushed = information * coefficients;
    let statistic = pushed.dot(&(pseudo_inverse(&middle) * &pushed));
    let (n, k) = (blocks as f64, freedom as f64);
    let f = statistic * (n - k) / (k * n);
    match FisherSnedecor::new(k, n - k) {
        Ok(distribution) if f.is_finite() => distribution.sf(f),
        _ => 1.0,
    }
}

/// Directions of the information that stand out of the base.
fn rank(information: &DMatrix<f64>, whole: &[f64]) -> usize {
    let n = information.nrows();
    if n == 0 {
        return 0;
    }
    let scale = |k: usize| if whole[k] > 0.0 { 1.0 / whole[k].sqrt() } else { 0.0 };
    let scaled = DMatrix::from_fn(n, n, |j, k| information[(j, k)] * scale(j) * scale(k));
    scaled.symmetric_eigenvalues().iter().filter(|value| **value > STANDS_OUT).count()
}

/// Inverse of a symmetric positive matrix, scaled to a unit diagonal, without the directions that
/// are rounding.
pub(crate) fn pseudo_inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    if n == 0 {
        return matrix.clone();
    }
    let scale = DVector::from_fn(n, |k, _| {
        let d = matrix[(k, k)];
        if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 }
    });
    let scaled = DMatrix::from_fn(n, n, |j, k| matrix[(j, k)] * scale[j] * scale[k]);
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.iter().fold(0.0_f64, |most, value| most.max(*value));
    let inverted =
        eigen.eigenvalues.map(|value| if value > ROUNDING * largest { 1.0 / value } else { 0.0 });
    let v = &eigen.eigenvectors;
    let inner = v * DMatrix::from_diagonal(&inverted) * v.transpose();
    DMatrix::from_fn(n, n, |j, k| inner[(j, k)] * scale[j] * scale[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gaussian;

    const VALUES: usize = 4000;

    fn wave(rate: f64) -> Vec<f64> {
        (0..VALUES).map(|k| (rate * k as f64).sin()).collect()
    }

    fn rows(columns: &[&Vec<f64>]) -> DMatrix<f64> {
        DMatrix::from_fn(columns.len(), VALUES, |row, k| columns[row][k])
    }

    #[test]
    fn a_gain_is_what_least_squares_takes_away() {
        let (base, other) = (wave(0.01), wave(0.037));
        let noise = gaussian(VALUES, 3);
        let residual: Vec<f64> =
            (0..VALUES).map(|k| 2.0 * base[k] + 0.5 * other[k] + noise[k]).collect();
        let projection = Projection::new(rows(&[&base]), &residual);
        let columns = rows(&[&other]);
        let explained = projection.explain(&columns);
        assert!((explained.coefficients[0] - 0.5).abs() < 0.1, "{explained:?}");
        let change = projection.change(&columns, &explained.coefficients);
        let after = projection.residual() - change;
        let fell = projection.residual().norm_squared() - after.norm_squared();
        assert!((fell / explained.gain - 1.0).abs() < 1e-9);
        assert_eq!((explained.rank, explained.stands_out[0] > 0.9), (1, true));
    }

    #[test]
    fn what_the_base_does_too_stands_out_of_nothing() {
        let (base, twice) = (wave(0.01), wave(0.01).iter().map(|v| 2.0 * v).collect::<Vec<_>>());
        let projection = Projection::new(rows(&[&base]), &gaussian(VALUES, 4));
        let explained = projection.explain(&rows(&[&twice]));
        assert!(explained.stands_out[0] < STANDS_OUT, "{explained:?}");
        assert_eq!(explained.rank, 0);
    }

    /// Share of small p values where nothing is there; a slow disturbance remembers 20 samples.
    fn alarms(block: usize) -> usize {
        let column = wave(0.02);
        let alarm = |seed: u64| {
            let mut state = 0.0;
            let slow: Vec<f64> = gaussian(VALUES, seed)
                .iter()
                .map(|draw| {
                    state = 0.95 * state + draw;
                    state
                })
                .collect();
            let projection = Projection::new(rows(&[&wave(0.5)]), &slow);
            let columns = rows(&[&column]);
            let explained = projection.explain(&columns);
            let change = projection.change(&columns, &explained.coefficients);
            let after = projection.residual() - &change;
            let change = change.transpose();
            let change = DMatrix::from_row_slice(1, VALUES, change.as_slice());
            let information = &change * change.transpose();
            let places: Vec<Place> =
                (0..VALUES).map(|sample| Place { recording: 0, sample, output: 0 }).collect();
            let one = DVector::from_element(1, 1.0);
            let by_block = |place: &Place| place.sample / block;
            wald(&change, &after, &information, &one, 1, &places, by_block) < 0.05
        };
        (0..200).filter(|seed| alarm(100 + seed)).count()
    }

    #[test]
    fn blocks_longer_than_the_memory_keep_the_level_and_single_values_do_not() {
        // 5 % of 200 are 10, with a standard deviation of 3.
        let (blocks, single) = (alarms(200), alarms(1));
        assert!(blocks < 24 && single > 100, "{blocks} {single}");
    }
}
