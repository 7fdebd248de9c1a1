//! The share outside against the designed one.
//!
//! Exceedances come in bursts, for residuals are correlated: the error of their share is taken from
//! the shares of blocks that are longer than what the correlation spans.

use drivescope_diagnoser::{Memory, MemoryError, Walk};

/// Samples of a block.
const BLOCK: usize = 200;
/// Blocks from which their spread tells the error of the share.
const ENOUGH: usize = 5;
/// A share of more than so many times the designed one is far from it ...
const FAR: f64 = 2.0;
/// ... or, where there are too few blocks to tell its error, of so many times.
const VERY_FAR: f64 = 6.0;
/// Standard errors beyond which it is no chance: one in a thousand.
const CHANCE: f64 = 3.1;

/// Counts values outside.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Outside {
    pub(crate) judged: usize,
    pub(crate) outside: usize,
    of_block: (usize, usize),
    blocks: usize,
    sum: f64,
    squares: f64,
}

impl Outside {
    /// Takes some values, so many of them outside.
    pub(crate) fn step(&mut self, judged: usize, outside: usize) {
        self.judged += judged;
        self.outside += outside;
        let (of, out) = &mut self.of_block;
        *of += judged;
        *out += outside;
        if *of >= BLOCK {
            let share = *out as f64 / *of as f64;
            self.blocks += 1;
            self.sum += share;
            self.squares += share * share;
            self.of_block = (0, 0);
        }
    }

    /// The share; none if nothing was judged.
    pub(crate) fn share(&self) -> Option<f64> {
        (self.judged > 0).then(|| self.outside as f64 / self.judged as f64)
    }

    /// Whether the share is far above the designed one, and not by chance.
    pub(crate) fn is_abnormal(&self, designed: f64) -> bool {
        let Some(share) = self.share() else { return false };
        if self.blocks < ENOUGH {
            return self.judged >= BLOCK / 2 && share > VERY_FAR * designed;
        }
        let n = self.blocks as f64;
        let mean = self.sum / n;
        let variance = ((self.squares - n * mean * mean) / (n - 1.0)).max(0.0);
        share > FAR * designed && share - designed > CHANCE * (variance / n).sqrt()
    }
}

impl Memory for Outside {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each([&mut self.judged, &mut self.outside])?;
        self.of_block.walk(walk)?;
        self.blocks.walk(walk)?;
        walk.each([&mut self.sum, &mut self.squares])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_far_from_the_designed_one_is_abnormal() {
        let of = |outside: fn(usize) -> bool, samples: usize| {
            let mut counted = Outside::default();
            (0..samples).for_each(|k| counted.step(1, usize::from(outside(k))));
            counted
        };
        assert!(!of(|k| k % 20 == 0, 5000).is_abnormal(0.05));
        assert!(of(|k| k % 6 == 0, 5000).is_abnormal(0.05));
        // One burst of twelve per cent of the run is no habit of it.
        assert!(!of(|k| (1000..1600).contains(&k), 5000).is_abnormal(0.05));
        assert!(of(|k| k % 2 == 0, 300).is_abnormal(0.05));
        assert!(!of(|_| true, 50).is_abnormal(0.05));
    }
}
