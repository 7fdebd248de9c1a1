//! What the machine can do at most: additions and multiplications a second, and how long one waits
//! for the one before it.

use std::hint::black_box;

use drivescope_numerics::dispatch::{Work, widest};
use serde::Serialize;

use super::clock::least;

/// Numbers side by side: eight vectors of the widest instructions, as many as are under way at once.
const SIDE_BY_SIDE: usize = 64;
const STEPS: usize = 20_000;

/// Bounds of one core.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Machine {
    /// Additions and multiplications a second, in the widest instructions that the program uses.
    pub(crate) flops: f64,
    /// Seconds from a number to the one that a multiplication and an addition make of it.
    pub(crate) latency_s: f64,
}

/// x = a x + b, again and again, of many numbers.
struct Chains<'a>(&'a mut [f64; SIDE_BY_SIDE]);

impl Work for Chains<'_> {
    #[inline(always)]
    fn run(self) {
        let mut x = *self.0;
        for _ in 0..STEPS {
            x = x.map(|x| 0.999 * x + 1e-3);
        }
        *self.0 = x;
    }
}

impl Machine {
    pub(super) fn measure() -> Self {
        let (mut many, mut one) = ([1.0; SIDE_BY_SIDE], 1.0);
        let mut all = || widest(Chains(black_box(&mut many)));
        let mut chain = || {
            // A factor that the compiler does not know: else the whole chain is one number.
            let factor = black_box(0.999);
            for _ in 0..STEPS {
                one = factor * one + 1e-3;
            }
            black_box(one);
        };
        let [throughput, latency] = least([&mut all, &mut chain]);
        let operations = (2 * SIDE_BY_SIDE * STEPS) as f64;
        Self { flops: operations / throughput, latency_s: latency / STEPS as f64 }
    }
}
