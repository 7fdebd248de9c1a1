//! The Kalman filter over a process: extended, the sensors taken one after the other.
//!
//! B. D. O. Anderson, J. B. Moore, Optimal Filtering, 1979, ch. 6 and 8.

use super::process::{Advanced, Belief, Process, Row, SENSORS, Sensed};

/// What the sensors told at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Correction<const N: usize> {
    /// Innovations in units of their standard deviations; 0 where nothing was measured.
    pub(crate) innovation: [f64; SENSORS],
    /// Inverse standard deviation of each; 0 where nothing was measured.
    pub(crate) inverse_sd: [f64; SENSORS],
    pub(crate) gain: [[f64; N]; SENSORS],
}

/// Half the logarithm of 2 pi.
const HALF_LOG_TWO_PI: f64 = 0.918_938_533_204_672_7;

impl<const N: usize> Correction<N> {
    /// Sum of squares of the innovations.
    pub(crate) fn squares(&self) -> f64 {
        self.innovation.iter().map(|w| w * w).sum()
    }

    /// Sensors that showed something.
    pub(crate) fn measured(&self) -> usize {
        self.inverse_sd.iter().filter(|inverse| **inverse > 0.0).count()
    }

    /// Logarithm of the density of what a sensor showed; 0 if it showed nothing.
    pub(crate) fn log_density(&self, sensor: usize) -> f64 {
        let inverse = self.inverse_sd[sensor];
        if inverse > 0.0 {
            inverse.ln() - HALF_LOG_TWO_PI - 0.5 * self.innovation[sensor].powi(2)
        } else {
            0.0
        }
    }
}

impl<const N: usize> Belief<N> {
    /// Takes in what the sensors show.
    #[inline]
    pub(crate) fn correct(&mut self, sensed: &Sensed<N>, row: &Row) -> Correction<N> {
        let predicted = self.mean;
        let mut made = Correction {
            innovation: [0.0; SENSORS],
            inverse_sd: [0.0; SENSORS],
            gain: [[0.0; N]; SENSORS],
        };
        for m in 0..SENSORS {
            if !row.shown[m].is_finite() || sensed.variance[m] <= 0.0 {
                continue;
            }
            let h = &sensed.rows[m];
            let mut seen = [0.0; N];
            let (mut variance, mut expected) = (sensed.variance[m], sensed.shown[m]);
            for r in 0..N {
                for c in 0..N {
                    seen[r] += self.covariance[r][c] * h[c];
                }
                variance += h[r] * seen[r];
                expected += h[r] * (self.mean[r] - predicted[r]);
            }
            let innovation = row.shown[m] - expected;
            for r in 0..N {
                let gain = seen[r] / variance;
                made.gain[m][r] = gain;
                self.mean[r] += gain * innovation;
                for c in 0..N {
                    self.covariance[r][c] -= gain * seen[c];
                }
            }
            made.inverse_sd[m] = 1.0 / variance.sqrt();
            made.innovation[m] = innovation * made.inverse_sd[m];
        }
        made
    }

    /// The belief one sample later.
    #[inline]
    pub(crate) fn moved(&self, by: &Advanced<N>) -> Self {
        let f = &by.transition;
        let mut half = [[0.0; N]; N];
        for r in 0..N {
            for k in 0..N {
                for c in 0..N {
                    half[r][c] += f[r][k] * self.covariance[k][c];
                }
            }
        }
        let mut covariance = by.added;
        for r in 0..N {
            for c in 0..=r {
                let mut sum = by.added[r][c];
                for k in 0..N {
                    sum += half[r][k] * f[c][k];
                }
                (covariance[r][c], covariance[c][r]) = (sum, sum);
            }
        }
        Self { mean: by.next, covariance }
    }
}

/// Filters on from a belief about the first row; `each` is told of every row.
pub(crate) fn filter<const N: usize, P: Process<N>>(
    process: &mut P,
    belief: &mut Belief<N>,
    rows: &[Row],
    mut each: impl FnMut(&Sensed<N>, &Correction<N>, &Advanced<N>),
) {
    for row in rows {
        let sensed = process.sense(&belief.mean, row);
        let correction = belief.correct(&sensed, row);
        let advanced = process.advance(belief, row);
        each(&sensed, &correction, &advanced);
        *belief = belief.moved(&advanced);
    }
}
