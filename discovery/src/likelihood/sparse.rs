//! Matrices of the filter's states of which few entries are not 0, times several columns at once.

use super::filter::{STATES, Vector};

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

/// The product of two square matrices, the first of which has few entries that are not 0.
#[inline(always)]
pub(crate) fn product(a: &Rows, b: &Rows) -> Rows {
    let mut product = NO_ROWS;
    for (sum, row) in product.iter_mut().zip(a) {
        for (factor, row) in row.iter().zip(b).filter(|(factor, _)| **factor != 0.0) {
            add(sum, *factor, row);
        }
    }
    product
}

/// The product of a square matrix with one column.
pub(crate) fn times(matrix: &Rows, column: &Vector) -> Vector {
    let of = |row: &Row| row.iter().zip(column).map(|(a, b)| a * b).sum();
    Vector::from_iterator(matrix.iter().map(of))
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
    pub(crate) fn of(matrix: &Rows, rows: usize) -> Self {
        let places = (0..rows).flat_map(|row| (0..STATES).map(move |column| (row, column)));
        let entry = |(row, column): (usize, usize)| Entry {
            row: row as u8,
            column: column as u8,
            value: matrix[row][column],
        };
        Self(places.map(entry).filter(|it| it.value != 0.0).collect())
    }

    /// Adds its product with columns to others.
    #[inline(always)]
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
        let mut matrix = NO_ROWS;
        (matrix[0][0], matrix[1][3], matrix[5][7], matrix[7][7]) = (2.0, -1.5, 0.25, 9.0);
        let sparse = Sparse::of(&matrix, 6);
        let vector = Vector::from_fn(|row, _| row as f64 + 1.0);
        let mut expected = times(&matrix, &vector);
        assert_eq!(expected[1], -6.0);
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
        assert_eq!(product(&unit(), &matrix), matrix);
        assert_eq!(product(&matrix, &matrix)[5], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.25]);
    }
}
