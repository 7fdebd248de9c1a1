//! Rows of lanes that start at a cache line.
//!
//! A vector of eight numbers that lies across two cache lines costs two loads or stores, and one that
//! was just stored has to be waited for: lanes of the exact step take a quarter longer then.

use aligned_vec::{AVec, RuntimeAlign};
use drivescope_numerics::Real;

/// Length of a cache line, bytes.
const LINE: usize = 64;

/// A number of rows `[R; N]`, from the start of a cache line on where a row fills one: memory that is
/// aligned costs more to take.
pub type Rows<R, const N: usize> = AVec<[R; N], RuntimeAlign>;

/// So many rows of zeros.
pub(crate) fn zeros<R: Real, const N: usize>(count: usize) -> Rows<R, N> {
    rows(std::iter::repeat_n([R::zero(); N], count))
}

/// Those rows.
pub(crate) fn rows<R, const N: usize>(of: impl IntoIterator<Item = [R; N]>) -> Rows<R, N> {
    let align = if size_of::<[R; N]>() >= LINE { LINE } else { align_of::<R>() };
    Rows::from_iter(align, of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use drivescope_numerics::Dual;

    #[test]
    fn rows_start_at_a_line_and_keep_their_values_through_a_copy() {
        let source: Vec<[f64; 16]> = (0..5).map(|k| [f64::from(k); 16]).collect();
        let made = rows(source.clone());
        for made in [&made, &made.clone()] {
            assert_eq!(**made, *source);
            assert_eq!(made.as_ptr() as usize % LINE, 0);
        }
    }

    #[test]
    fn rows_shorter_than_a_line_take_no_more_than_they_need() {
        let short: Rows<f64, 1> = zeros(3);
        assert_eq!((short.len(), short.alignment()), (3, align_of::<f64>()));
        assert_eq!(zeros::<Dual<8>, 4>(2).len(), 2);
        assert!(zeros::<f64, 32>(0).is_empty());
    }
}
