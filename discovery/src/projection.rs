//! What of a list of values no combination of some columns holds: linear least squares.

use nalgebra::{DMatrix, DVector};

/// Relative size below which a direction of the columns is nothing but rounding.
const ROUNDING: f64 = 1e-11;

/// The values without what the columns (one a row) hold of them.
pub(crate) fn beside(columns: &DMatrix<f64>, values: &[f64]) -> Vec<f64> {
    let values = DVector::from_column_slice(values);
    let step = step(columns * columns.transpose(), &(columns * &values));
    (values - columns.tr_mul(&step)).as_slice().to_vec()
}

/// Coefficients of the columns of which those are the products with each other and with the values.
fn step(information: DMatrix<f64>, products: &DVector<f64>) -> DVector<f64> {
    let scale = information.diagonal().map(|it| if it > 0.0 { 1.0 / it.sqrt() } else { 0.0 });
    let scale = DMatrix::from_diagonal(&scale);
    let scaled = &scale * information * &scale;
    &scale * pseudo_inverse(scaled, ROUNDING) * &scale * products
}

/// The same of values that come block by block: products of columns and values take no memory a value.
pub(crate) struct Normal {
    information: DMatrix<f64>,
    products: DVector<f64>,
    squares: f64,
}

impl Normal {
    /// Of so many columns, without values yet.
    pub(crate) fn new(columns: usize) -> Self {
        Self {
            information: DMatrix::zeros(columns, columns),
            products: DVector::zeros(columns),
            squares: 0.0,
        }
    }

    /// Adds values with some of the columns (one a row), those at `places`; the others are zero there.
    pub(crate) fn add(&mut self, places: &[usize], columns: &DMatrix<f64>, values: &[f64]) {
        let values = DVector::from_column_slice(values);
        let (information, products) = (columns * columns.transpose(), columns * &values);
        for (k, row) in places.iter().enumerate() {
            self.products[*row] += products[k];
            for (j, column) in places.iter().enumerate() {
                self.information[(*row, *column)] += information[(k, j)];
            }
        }
        self.squares += values.norm_squared();
    }

    /// Sum of the squared values.
    pub(crate) fn squares(&self) -> f64 {
        self.squares
    }

    /// The same without what the columns hold of them.
    pub(crate) fn left(&self) -> f64 {
        let step = step(self.information.clone(), &self.products);
        self.squares - step.dot(&self.products)
    }
}

/// Inverse of a symmetric positive matrix without the directions that hold at most that share of the
/// largest one: the smallest solution.
pub(crate) fn pseudo_inverse(matrix: DMatrix<f64>, least: f64) -> DMatrix<f64> {
    let n = matrix.nrows();
    if n == 0 {
        return matrix;
    }
    let eigen = matrix.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut inverse = DMatrix::zeros(n, n);
    for (value, v) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > least * largest {
            inverse.ger(1.0 / value, &v, &v, 1.0);
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gaussian;

    #[test]
    fn what_the_columns_hold_goes_and_the_rest_stays() {
        let n = 1000;
        let noise = gaussian(n, 3);
        // The third is the sum of the others, and one is nothing: neither may matter.
        let ramp = |k: usize| k as f64 / n as f64;
        let columns = DMatrix::from_fn(4, n, |row, k| [1.0, ramp(k), 1.0 + ramp(k), 0.0][row]);
        let values: Vec<f64> = (0..n).map(|k| 30.0 - 7.0 * ramp(k) + noise[k]).collect();
        let remainder = beside(&columns, &values);
        for row in 0..4 {
            let dot: f64 = columns.row(row).iter().zip(&remainder).map(|(a, b)| a * b).sum();
            assert!(dot.abs() < 1e-6, "column {row}: {dot}");
        }
        let power = |values: &[f64]| values.iter().map(|it| it * it).sum::<f64>();
        let (kept, whole) = (power(&remainder), power(&noise));
        assert!(kept <= whole && kept > 0.98 * whole, "{kept} of {whole}");
        assert_eq!(beside(&DMatrix::zeros(0, n), &values), values);
        // Block by block, the columns in other places.
        let mut normal = Normal::new(5);
        for from in (0..n).step_by(100) {
            let block = columns.columns(from, 100).into_owned();
            normal.add(&[4, 0, 3, 1], &block, &values[from..from + 100]);
        }
        assert!((normal.squares() / power(&values) - 1.0).abs() < 1e-12);
        assert!((normal.left() / kept - 1.0).abs() < 1e-9, "{} of {kept}", normal.left());
    }
}
