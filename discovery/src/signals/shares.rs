//! How much of what drives the motion explains, at any shift in time and with either sign.
//!
//! What drives a machine accelerates its inertia and overcomes its friction and its back-EMF: the
//! acceleration, the speed and the sign of the speed enter with positive coefficients, whatever the
//! machine is. A constant, and what depends on the angle (gravity), may have either sign. The share
//! of the driver's variance that such a sum explains is high where the signals belong together, and
//! that of a shifted, reversed or foreign signal is not: no value of any parameter is needed.

use nalgebra::{DMatrix, DVector};

/// Least share of a column that must be left beside the others.
const INDEPENDENT: f64 = 1e-6;

/// What is explained at one shift, as a share of the driver's variance.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Explained {
    /// By what may have either sign.
    pub(super) free: f64,
    /// Further, by the signed columns with their right signs.
    pub(super) right: f64,
    /// Further, by the signed columns with their signs reversed.
    pub(super) reversed: f64,
}

/// Some of the signed columns, and the inverse of their products.
struct Subset {
    of: Vec<usize>,
    inverse: DMatrix<f64>,
}

/// The columns, made orthogonal to what is free.
pub(super) struct Columns {
    free: Vec<Vec<f64>>,
    signed: Vec<Vec<f64>>,
    subsets: Vec<Subset>,
}

impl Columns {
    /// Of columns with positive coefficients, and of columns with any, beside a constant.
    pub(super) fn new(signed: Vec<Vec<f64>>, free: Vec<Vec<f64>>) -> Self {
        let rows = signed.first().map_or(0, Vec::len);
        let mut kept: Vec<Vec<f64>> = Vec::new();
        for column in std::iter::once(vec![1.0; rows]).chain(free) {
            kept.extend(beside(&kept, column));
        }
        let signed: Vec<_> = signed.into_iter().filter_map(|it| beside(&kept, it)).collect();
        let subsets = (1..1usize << signed.len()).filter_map(|bits| {
            let of: Vec<usize> = (0..signed.len()).filter(|k| bits >> k & 1 == 1).collect();
            let product = |i: usize, j: usize| dot(&signed[of[i]], &signed[of[j]]);
            let products = DMatrix::from_fn(of.len(), of.len(), product);
            (products.determinant() > INDEPENDENT).then_some(())?;
            Some(Subset { inverse: products.try_inverse()?, of })
        });
        let subsets = subsets.collect();
        Self { free: kept, signed, subsets }
    }

    /// The driver `y`, of mean zero and of these squares, read `lag` windows later, in a circle.
    pub(super) fn explained(&self, y: &[f64], squares: f64, lag: isize) -> Explained {
        let n = y.len();
        let split = lag.rem_euclid(n as isize) as usize;
        let along = |column: &Vec<f64>| {
            dot(&column[..n - split], &y[split..]) + dot(&column[n - split..], &y[..split])
        };
        let free: f64 = self.free.iter().map(|it| along(it).powi(2)).sum();
        let shown: Vec<f64> = self.signed.iter().map(along).collect();
        let mut best = [0.0_f64; 2];
        for subset in &self.subsets {
            let target =
                DVector::from_iterator(subset.of.len(), subset.of.iter().map(|k| shown[*k]));
            let found = &subset.inverse * &target;
            let gain = found.dot(&target);
            // Reversed signs are right signs of the reversed driver.
            if found.iter().all(|it| *it >= 0.0) {
                best[0] = best[0].max(gain);
            } else if found.iter().all(|it| *it <= 0.0) {
                best[1] = best[1].max(gain);
            }
        }
        let [right, reversed] = best.map(|gain| gain / squares);
        Explained { free: free / squares, right, reversed }
    }
}

/// The column beside orthonormal ones, of length 1; none if nothing is left of it.
fn beside(others: &[Vec<f64>], mut column: Vec<f64>) -> Option<Vec<f64>> {
    let whole = dot(&column, &column);
    for other in others {
        let share = dot(other, &column);
        column.iter_mut().zip(other).for_each(|(value, other)| *value -= share * other);
    }
    let remainder = dot(&column, &column);
    (remainder > INDEPENDENT * whole).then(|| {
        let length = remainder.sqrt();
        column.iter_mut().for_each(|value| *value /= length);
        column
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gaussian;

    #[test]
    fn signs_and_shifts_are_told() {
        let [a, b, load] = [1, 2, 3].map(|seed| gaussian(500, seed));
        let columns = Columns::new(vec![a.clone(), b.clone()], vec![load.clone()]);
        let y: Vec<f64> = (0..500).map(|k| a[k] + 0.5 * b[k] - 2.0 * load[k]).collect();
        let mean = y.iter().sum::<f64>() / 500.0;
        let y: Vec<f64> = y.iter().map(|value| value - mean).collect();
        let squares = dot(&y, &y);
        let whole = |it: Explained| it.free + it.right;
        assert!((whole(columns.explained(&y, squares, 0)) - 1.0).abs() < 1e-9);
        let reversed: Vec<f64> = y.iter().map(|value| -value).collect();
        let found = columns.explained(&reversed, squares, 0);
        assert!(
            (found.free + found.reversed - 1.0).abs() < 1e-9 && found.right < 0.02,
            "{found:?}"
        );
        let late: Vec<f64> = (0..500).map(|k| y[(k + 500 - 7) % 500]).collect();
        assert!(whole(columns.explained(&late, squares, 0)) < 0.1);
        assert!((whole(columns.explained(&late, squares, 7)) - 1.0).abs() < 1e-9);
    }
}
