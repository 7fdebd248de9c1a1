//! Rows of lanes that start at a cache line.
//!
//! A vector of eight numbers that lies across two cache lines costs two loads or stores, and an
//! allocation starts anywhere: the rows are laid into a flat one from its first cache line on.

use std::ops::{Deref, DerefMut};

use drivescope_numerics::Real;

/// Length of a cache line, bytes.
const LINE: usize = 64;

/// A number of rows `[R; N]`, aligned to cache lines where a row fills at least one.
#[derive(Debug)]
pub(crate) struct Rows<R, const N: usize> {
    flat: Vec<R>,
    /// Where in `flat` the rows begin and end.
    first: usize,
    end: usize,
}

impl<R: Real, const N: usize> Rows<R, N> {
    /// So many rows of zeros.
    pub(crate) fn zero(count: usize) -> Self {
        Self::filled(count, R::zero())
    }
}

impl<R: Clone, const N: usize> Rows<R, N> {
    fn filled(count: usize, value: R) -> Self {
        // Some number within a line's worth of them starts a line.
        let spare = if size_of::<[R; N]>() >= LINE { LINE / align_of::<R>() } else { 0 };
        let flat = vec![value; count * N + spare];
        // The offset is out of range if none does.
        let offset = flat.as_ptr().align_offset(LINE);
        let first = if offset <= spare { offset } else { 0 };
        Self { flat, first, end: first + count * N }
    }

    /// A copy of those rows.
    pub(crate) fn copied(from: &[[R; N]]) -> Self {
        match from.as_flattened().first() {
            Some(value) => {
                let mut rows = Self::filled(from.len(), value.clone());
                rows.clone_from_slice(from);
                rows
            }
            None => Self { flat: Vec::new(), first: 0, end: 0 },
        }
    }
}

impl<R: Clone, const N: usize> Clone for Rows<R, N> {
    fn clone(&self) -> Self {
        Self::copied(self)
    }
}

impl<R, const N: usize> Deref for Rows<R, N> {
    type Target = [[R; N]];

    #[inline(always)]
    fn deref(&self) -> &[[R; N]] {
        self.flat[self.first..self.end].as_chunks().0
    }
}

impl<R, const N: usize> DerefMut for Rows<R, N> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [[R; N]] {
        self.flat[self.first..self.end].as_chunks_mut().0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use drivescope_numerics::Dual;

    #[test]
    fn rows_start_at_a_line_and_keep_their_values_through_a_copy() {
        let source: Vec<[f64; 16]> = (0..5).map(|k| [f64::from(k); 16]).collect();
        let rows = Rows::copied(&source);
        for rows in [&rows, &rows.clone()] {
            assert_eq!(**rows, *source);
            assert_eq!(rows.as_ptr() as usize % LINE, 0);
        }
    }

    #[test]
    fn rows_shorter_than_a_line_take_no_more_than_they_need() {
        let rows = Rows::<f64, 1>::zero(3);
        assert_eq!((rows.len(), rows.flat.len()), (3, 3));
        assert_eq!(Rows::<Dual<8>, 4>::zero(2).len(), 2);
        assert!(Rows::<f64, 32>::zero(0).is_empty());
    }
}
