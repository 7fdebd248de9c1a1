//! Stuck sensors: a value that repeats itself to the last digit.
//!
//! A stuck sensor shows its last value with certainty. A healthy one shows it by chance, with the
//! probability p of the quantum that the value lies in, as the filter predicts it. The likelihood
//! ratio of a run of repetitions is the product of their 1 / p, and one change ends it.

use super::filter::Correction;
use super::process::{Row, SENSORS};
use crate::memory::{Memory, MemoryError, Walk};

/// Steps in a standard deviation of a sensor that is read in finer ones than its noise: how often
/// such values repeat by chance is below anything that matters.
const FINE: f64 = 1e4;

/// Runs of repeated values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frozen {
    last: [f64; SENSORS],
    /// Logarithm of the likelihood ratio, and the first repetition.
    runs: [(f64, usize); SENSORS],
}

/// Logarithm of the probability of the quantum that a value lies in.
pub(crate) fn log_probability<const N: usize>(
    correction: &Correction<N>,
    sensor: usize,
    quantum: f64,
) -> f64 {
    let fine = 1.0 / (FINE * correction.inverse_sd[sensor]);
    (correction.log_density(sensor) + quantum.max(fine).ln()).min(0.0)
}

impl Frozen {
    pub(crate) fn new() -> Self {
        Self { last: [f64::NAN; SENSORS], runs: [(0.0, 0); SENSORS] }
    }

    /// Takes in the row `now`.
    #[inline]
    pub(crate) fn step<const N: usize>(
        &mut self,
        now: usize,
        row: &Row,
        correction: &Correction<N>,
        quanta: &[f64; SENSORS],
    ) {
        for m in 0..SENSORS {
            let run = &mut self.runs[m];
            if row.shown[m] == self.last[m] && correction.inverse_sd[m] > 0.0 {
                if run.0 == 0.0 {
                    run.1 = now;
                }
                run.0 -= log_probability(correction, m, quanta[m]);
            } else {
                run.0 = 0.0;
            }
        }
        self.last = row.shown;
    }

    /// The longest run: logarithm of its likelihood ratio, sensor, first repetition.
    #[inline]
    pub(crate) fn peak(&self) -> (f64, usize, usize) {
        let mut best = (f64::NEG_INFINITY, 0, 0);
        for (m, (ratio, onset)) in self.runs.into_iter().enumerate() {
            if ratio > best.0 {
                best = (ratio, m, onset);
            }
        }
        best
    }
}

impl Memory for Frozen {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.last.walk(walk)?;
        self.runs.walk(walk)
    }
}
