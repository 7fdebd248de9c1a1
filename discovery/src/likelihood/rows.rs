//! Matrices of the filter's states, times several columns at once.

use super::state::{LOAD, STATES, Vector};

/// Columns that are handled together.
pub(crate) const LANES: usize = 8;
/// One value of each of those columns.
pub(crate) type Row = [f64; LANES];
/// One row a state.
pub(crate) type Rows = [Row; STATES];

pub(crate) const NO_ROWS: Rows = [[0.0; LANES]; STATES];

/// Adds a multiple of one row to another.
#[inline(always)]
pub(crate) fn add(sum: &mut Row, factor: f64, row: &Row) {
    for (sum, value) in sum.iter_mut().zip(row) {
        *sum += factor * value;
    }
}

/// The square matrix that changes nothing.
#[inline(always)]
pub(crate) fn unit() -> Rows {
    let mut unit = NO_ROWS;
    (0..STATES).for_each(|state| unit[state][state] = 1.0);
    unit
}

/// The product of two square matrices.
#[inline(always)]
pub(crate) fn product(a: &Rows, b: &Rows) -> Rows {
    let mut product = NO_ROWS;
    add_product(a, b, &mut product);
    product
}

/// Adds the product of a matrix with columns to as many rows as it has. To multiply by the entries
/// that are 0 costs less than to leave them out: each sum stays in a register.
#[inline(always)]
fn add_product<const N: usize>(a: &[Row; N], b: &Rows, sums: &mut Rows) {
    for (sum, factors) in sums.iter_mut().zip(a) {
        let mut total = *sum;
        for (factor, row) in factors.iter().zip(b) {
            add(&mut total, *factor, row);
        }
        *sum = total;
    }
}

/// The product of a square matrix with one column.
pub(crate) fn times(matrix: &Rows, column: &Vector) -> Vector {
    let of = |row: &Row| row.iter().zip(column).map(|(a, b)| a * b).sum();
    Vector::from_iterator(matrix.iter().map(of))
}

/// A matrix with a row for each state before the disturbances, and a column for each state.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Upper([Row; LOAD]);

impl Upper {
    /// The first `rows` rows of a matrix, the others 0.
    pub(crate) fn of(matrix: &Rows, rows: usize) -> Self {
        let row = |row: usize| if row < rows { matrix[row] } else { [0.0; STATES] };
        Self(std::array::from_fn(row))
    }

    /// Adds its product with columns to others.
    #[inline(always)]
    pub(crate) fn add_times(&self, columns: &Rows, sums: &mut Rows) {
        add_product(&self.0, columns, sums);
    }

    /// Its product with one column.
    pub(crate) fn times(&self, column: &Vector) -> Vector {
        let mut product = Vector::zeros();
        for (sum, row) in product.iter_mut().zip(&self.0) {
            *sum = row.iter().zip(column).map(|(a, b)| a * b).sum();
        }
        product
    }

    /// One of its columns.
    pub(crate) fn column(&self, column: usize) -> Vector {
        let mut values = Vector::zeros();
        for (value, row) in values.iter_mut().zip(&self.0) {
            *value = row[column];
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_first_rows() {
        let mut matrix = NO_ROWS;
        (matrix[0][0], matrix[1][3], matrix[5][7], matrix[7][7]) = (2.0, -1.5, 0.25, 9.0);
        let upper = Upper::of(&matrix, 6);
        let vector = Vector::from_fn(|row, _| row as f64 + 1.0);
        let mut expected = times(&matrix, &vector);
        assert_eq!(expected[1], -6.0);
        expected[7] = 0.0;
        assert_eq!(upper.times(&vector), expected);
        let columns: Rows =
            std::array::from_fn(|row| std::array::from_fn(|lane| vector[row] * lane as f64));
        let mut sum = NO_ROWS;
        upper.add_times(&columns, &mut sum);
        for (row, lanes) in sum.iter().enumerate() {
            assert_eq!(lanes[3], 3.0 * expected[row]);
        }
        assert_eq!(upper.column(7)[5], 0.25);
        assert_eq!(product(&unit(), &matrix), matrix);
        assert_eq!(product(&matrix, &matrix)[5], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.25]);
    }
}
