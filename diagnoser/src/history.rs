//! The last n values of a signal, newest first, in one contiguous piece.
//!
//! Every value is written twice, n places apart, so that a window of n never wraps around: the
//! filters above it are plain scalar products.

use crate::memory::{Memory, MemoryError, Walk};

/// Fixed memory for the last values of a signal; zeros before the first.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct History {
    twice: Vec<f64>,
    newest: usize,
}

impl History {
    pub(crate) fn new(length: usize) -> Self {
        Self { twice: vec![0.0; 2 * length], newest: 0 }
    }

    pub(crate) fn clear(&mut self) {
        self.twice.fill(0.0);
        self.newest = 0;
    }

    #[inline]
    pub(crate) fn push(&mut self, value: f64) {
        let length = self.twice.len() / 2;
        if length == 0 {
            return;
        }
        self.newest = if self.newest == 0 { length - 1 } else { self.newest - 1 };
        self.twice[self.newest] = value;
        self.twice[self.newest + length] = value;
    }

    /// The last values, newest first.
    #[inline]
    pub(crate) fn window(&self) -> &[f64] {
        &self.twice[self.newest..][..self.twice.len() / 2]
    }
}

impl Memory for History {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each(&mut self.twice)?;
        walk.below(&mut self.newest, (self.twice.len() / 2).max(1))
    }
}

/// Scalar product in four partial sums: the additions do not wait for each other.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut partial = [0.0; 4];
    let (a_head, a_tail) = a.as_chunks::<4>();
    let (b_head, b_tail) = b.as_chunks::<4>();
    for (a, b) in a_head.iter().zip(b_head) {
        for lane in 0..4 {
            partial[lane] += a[lane] * b[lane];
        }
    }
    let tail: f64 = a_tail.iter().zip(b_tail).map(|(a, b)| a * b).sum();
    (partial[0] + partial[1]) + (partial[2] + partial[3]) + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_holds_the_newest_values_first() {
        let mut history = History::new(3);
        for value in 1..=8 {
            history.push(f64::from(value));
        }
        assert_eq!(history.window(), [8.0, 7.0, 6.0]);
        history.clear();
        assert_eq!(history.window(), [0.0; 3]);
        let mut none = History::new(0);
        none.push(1.0);
        assert!(none.window().is_empty());
    }

    #[test]
    fn the_scalar_product_takes_every_term() {
        let a: Vec<f64> = (1..=11).map(f64::from).collect();
        assert_eq!(dot(&a, &a), 506.0);
    }
}
