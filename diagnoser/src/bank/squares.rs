//! Innovations that are larger than the process makes them, whatever their shape: a cumulative sum
//! of the likelihood ratio of a raised standard deviation (M. Basseville, I. V. Nikiforov,
//! Detection of Abrupt Changes, 1993, ch. 2.2).

use super::filter::Correction;
use crate::memory::{Memory, MemoryError, Walk};

/// Standard deviation that is looked for, in units of the healthy one.
const RAISED: f64 = 1.5;

/// The cumulative sum and where its rise began.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Squares {
    pub(crate) ratio: f64,
    pub(crate) onset: usize,
}

impl Squares {
    /// Takes in the innovations of sample `now`.
    #[inline]
    pub(crate) fn step<const N: usize>(&mut self, now: usize, correction: &Correction<N>) {
        if self.ratio == 0.0 {
            self.onset = now;
        }
        let gain = 0.5 * (1.0 - 1.0 / (RAISED * RAISED)) * correction.squares();
        let change = gain - correction.measured() as f64 * RAISED.ln();
        self.ratio = (self.ratio + change).max(0.0);
    }
}

impl Memory for Squares {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.ratio.walk(walk)?;
        self.onset.walk(walk)
    }
}
