//! Matrices of the filter's states of which few entries are not 0, times several columns at once.

use super::filter::{STATES, Square, Vector};

/// Columns that are handled together.
pub(crate) const LANES: usize = 8;
/// One value of each of those columns.
pub(crate) type Row = [f64; LANES];
/// One row a state.
pub(crate) type Rows = [Row; STATES];

pub(crate) const NO_ROWS: Rows = [[0.0; LANES]; STATES];

/// Adds a multiple of one row to another.
pub(crate) fn add(sum: &mut Row, factor: f64, row: &Row) {
    for (sum, value) in sum.iter_mut().zip(row) {
        *sum += factor * value;
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Entry {
    row: u8,
    column: u8,
    value: f64,
}

/// The entries that are not 0.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Sparse(Vec<Entry>);

impl Sparse {
    /// Those of the first `rows` rows of a matrix.
    pub(crate) fn of(matrix: &Square, rows: usize) -> Self {
        let places = (0..rows).flat_map(|row| (0..STATES).map(move |column| (row, column)));
        let entry = |(row, column)| Entry {
            row: row as u8,
            column: column as u8,
            value: matrix[(row, column)],
        };
        Self(places.map(entry).filter(|it| it.value != 0.0).collect())
    }

    /// Adds its product with columns to others.
    pub(crate) fn add_times(&self, columns: &Rows, sum: &mut Rows) {
        for it in &self.0 {
            add(
                &mut sum[usize::from(it.row) % STATES],
                it.value,
                &columns[usize::from(it.column) % STATES],
            );
        }
    }

    /// Its product with one column.
    pub(crate) fn times(&self, column: &Vector) -> Vector {
        let mut product = Vector::zeros();
        for it in &self.0 {
            product[usize::from(it.row)] += it.value * column[usize::from(it.column)];
        }
        product
    }

    /// One of its columns.
    pub(crate) fn column(&self, column: usize) -> Vector {
        let mut values = Vector::zeros();
        for it in self.0.iter().filter(|it| usize::from(it.column) == column) {
            values[usize::from(it.row)] = it.value;
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_whole_matrix() {
        let mut matrix = Square::zeros();
        (matrix[(0, 0)], matrix[(1, 3)], matrix[(5, 7)], matrix[(7, 7)]) = (2.0, -1.5, 0.25, 9.0);
        let sparse = Sparse::of(&matrix, 6);
        let vector = Vector::from_fn(|row, _| row as f64 + 1.0);
        let mut expected = matrix * vector;
        expected[7] = 0.0;
        assert_eq!(sparse.times(&vector), expected);
        let columns: Rows =
            std::array::from_fn(|row| std::array::from_fn(|lane| vector[row] * lane as f64));
        let mut sum = NO_ROWS;
        sparse.add_times(&columns, &mut sum);
        for (row, lanes) in sum.iter().enumerate() {
            assert_eq!(lanes[3], 3.0 * expected[row]);
        }
        assert_eq!(sparse.column(7)[5], 0.25);
    }
}
