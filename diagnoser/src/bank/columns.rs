//! What sizes of faults do to the whitened innovations, in double precision.

use super::filter::Correction;
use super::process::{Advanced, SENSORS, Sensed};

/// `C` columns from one onset: their scores on the innovations and their Gram matrix.
#[derive(Debug, Clone)]
pub(crate) struct Columns<const N: usize, const C: usize> {
    /// Derivative by each size of what the filter's prediction lacks.
    e: [[f64; C]; N],
    pub(crate) score: [f64; C],
    pub(crate) gram: [[f64; C]; C],
}

impl<const N: usize, const C: usize> Columns<N, C> {
    pub(crate) fn new() -> Self {
        Self { e: [[0.0; C]; N], score: [0.0; C], gram: [[0.0; C]; C] }
    }

    /// Takes in a sample at which the sizes act on sensors and states by these derivatives.
    #[inline(always)]
    pub(crate) fn step(
        &mut self,
        (on_sensors, on_states): (&[[f64; C]; SENSORS], &[[f64; C]; N]),
        sensed: &Sensed<N>,
        correction: &Correction<N>,
        advanced: &Advanced<N>,
    ) {
        for m in (0..SENSORS).filter(|m| correction.inverse_sd[*m] > 0.0) {
            let mut w = on_sensors[m];
            for n in 0..N {
                (0..C).for_each(|j| w[j] += sensed.rows[m][n] * self.e[n][j]);
            }
            for n in 0..N {
                (0..C).for_each(|j| self.e[n][j] -= correction.gain[m][n] * w[j]);
            }
            w = w.map(|lacking| lacking * correction.inverse_sd[m]);
            for j in 0..C {
                self.score[j] += w[j] * correction.innovation[m];
                (0..C).for_each(|i| self.gram[j][i] += w[j] * w[i]);
            }
        }
        let mut next = *on_states;
        for r in 0..N {
            for n in 0..N {
                (0..C).for_each(|j| next[r][j] += advanced.transition[r][n] * self.e[n][j]);
            }
        }
        self.e = next;
    }
}
