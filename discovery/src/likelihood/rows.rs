//! Matrices of the filter's states, times several columns at once.

use drivescope_plant::model::{CURRENT, OWN, POSITION, SPEED};

use super::state::{LOAD, STATES, VOLTAGE, Vector};

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

/// Adds the product of a square matrix with columns. To multiply by the entries that are 0 costs less
/// than to leave them out: each sum stays in a register.
#[inline(always)]
fn add_product(a: &Rows, b: &Rows, sums: &mut Rows) {
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

/// The states of a drive whose effects have none: few have own ones, and to leave those out costs a
/// third.
const WITHOUT_OWN: [usize; OWN + 2] = [CURRENT, SPEED, POSITION, LOAD, VOLTAGE];
const ALL: [usize; STATES] = [0, 1, 2, 3, 4, 5, LOAD, VOLTAGE];

/// A matrix with a row for each state before the disturbances, and a column for each state.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Upper {
    rows: [Row; LOAD],
    /// Whether own states have a part in it.
    own: bool,
}

impl Upper {
    /// The first `rows` rows of a matrix, the others 0.
    pub(crate) fn of(matrix: &Rows, rows: usize) -> Self {
        let row = |row: usize| if row < rows { matrix[row] } else { [0.0; STATES] };
        let rows: [Row; LOAD] = std::array::from_fn(row);
        let is_own = |row: usize| {
            let of_own = if row < OWN { OWN..LOAD } else { 0..STATES };
            rows[row][of_own].iter().any(|it| *it != 0.0)
        };
        Self { rows, own: (0..LOAD).any(is_own) }
    }

    /// Puts its product with columns, whose load is that, in the place of the states before the
    /// disturbances, with what is added.
    #[inline(always)]
    pub(crate) fn advance(&self, columns: &mut Rows, load: &Row, added: &Rows) {
        if self.own {
            self.put::<LOAD, STATES>(&ALL, columns, load, added);
        } else {
            self.put::<OWN, { OWN + 2 }>(&WITHOUT_OWN, columns, load, added);
        }
    }

    #[inline(always)]
    fn put<const ROWS: usize, const COUNT: usize>(
        &self,
        states: &[usize; COUNT],
        columns: &mut Rows,
        load: &Row,
        added: &Rows,
    ) {
        let mut next = [[0.0; LANES]; ROWS];
        next.copy_from_slice(&added[..ROWS]);
        // The sums stay in registers, a row a register. A row after the other, the compiler goes over four
        // rows at once and gathers their lanes from everywhere, four times slower. No closure: it would be
        // compiled without the instructions of who calls.
        for state in states {
            let with = if *state == LOAD { *load } else { columns[*state] };
            for (sum, factors) in next.iter_mut().zip(&self.rows) {
                add(sum, factors[*state], &with);
            }
        }
        columns[..ROWS].copy_from_slice(&next);
        columns[ROWS..LOAD].copy_from_slice(&added[ROWS..LOAD]);
    }

    /// Its product with columns, in the states before the disturbances.
    #[inline(always)]
    pub(crate) fn product(&self, columns: &Rows) -> Rows {
        let mut product = *columns;
        self.advance(&mut product, &columns[LOAD], &NO_ROWS);
        product[LOAD..].fill([0.0; LANES]);
        product
    }

    /// Its product with one column.
    pub(crate) fn times(&self, column: &Vector) -> Vector {
        let mut product = Vector::zeros();
        for (sum, row) in product.iter_mut().zip(&self.rows) {
            *sum = row.iter().zip(column).map(|(a, b)| a * b).sum();
        }
        product
    }

    /// One of its columns.
    pub(crate) fn column(&self, column: usize) -> Vector {
        let mut values = Vector::zeros();
        for (value, row) in values.iter_mut().zip(&self.rows) {
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
        for (row, lanes) in upper.product(&columns).iter().enumerate() {
            assert_eq!(lanes[3], 3.0 * expected[row]);
        }
        assert_eq!(upper.column(7)[5], 0.25);
        // Without own states: what is added to them stays, and the load is the one that is given.
        let mut plain = NO_ROWS;
        (plain[0][0], plain[1][6], plain[2][1]) = (0.5, 2.0, 1.0);
        let added: Rows = std::array::from_fn(|row| [row as f64; LANES]);
        let mut moved = columns;
        Upper::of(&plain, 3).advance(&mut moved, &[10.0; LANES], &added);
        let expected = [1.5, 21.0, 8.0, 3.0, 4.0, 5.0, 21.0, 24.0];
        assert_eq!(moved.map(|row| row[3]), expected);
        assert_eq!(product(&unit(), &matrix), matrix);
        assert_eq!(product(&matrix, &matrix)[5], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.25]);
    }
}
