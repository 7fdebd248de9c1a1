//! Limits from a designed mean time between false alarms.
//!
//! Maxima of a likelihood ratio over healthy blocks have an exponential tail: above a level u that
//! one block in ten exceeds, the rate of alarms is lambda(u) e^(-beta (h - u)). beta is the inverse
//! mean excess (peaks over a threshold: S. Coles, An Introduction to Statistical Modeling of
//! Extreme Values, 2001, ch. 4, with shape 0), taken at its lower 95 % limit, for the limit is
//! extrapolated.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Samples of a block: longer than what one disturbance keeps a statistic raised.
const BLOCK: usize = 400;
/// Share of the blocks whose maxima make the tail.
const TAIL: f64 = 0.1;
/// Fewest maxima in the tail.
const FEWEST: usize = 30;
/// One-sided 95 % of a normal distribution.
pub(crate) const ONE_SIDED_95: f64 = 1.645;

/// Why there is no tail.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TailError {
    /// Too few samples.
    #[error("a limit needs {needed} healthy samples or more, there are {samples}")]
    TooFew {
        /// Samples given.
        samples: usize,
        /// Samples needed.
        needed: usize,
    },
}

/// The tail of a statistic on healthy samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tail {
    level: f64,
    /// Alarms a sample at that level.
    rate: f64,
    /// Logarithm of the rate a unit of the statistic.
    slope: f64,
}

impl Tail {
    /// The tail of those values of a statistic, sample by sample.
    ///
    /// # Errors
    /// Too few of them.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Result<Self, TailError> {
        let (mut maxima, mut samples) = (Vec::new(), 0);
        let mut greatest = f64::NEG_INFINITY;
        for value in values {
            greatest = greatest.max(value);
            samples += 1;
            if samples % BLOCK == 0 {
                maxima.push(std::mem::replace(&mut greatest, f64::NEG_INFINITY));
            }
        }
        let in_tail = (TAIL * maxima.len() as f64) as usize;
        if in_tail < FEWEST {
            let needed = (FEWEST as f64 / TAIL) as usize * BLOCK;
            return Err(TailError::TooFew { samples, needed });
        }
        maxima.sort_by(|a, b| b.total_cmp(a));
        let level = maxima[in_tail];
        let excess: f64 = maxima[..in_tail].iter().map(|maximum| maximum - level).sum();
        let n = in_tail as f64;
        let lower = 1.0 - ONE_SIDED_95 / n.sqrt();
        let rate = -(1.0 - n / maxima.len() as f64).ln() / BLOCK as f64;
        Ok(Self { level, rate, slope: lower * n / excess })
    }

    /// The limit that is exceeded once in `arl_0` samples on average, not below the tail.
    pub fn limit(&self, arl_0: f64) -> f64 {
        self.level + (self.rate * arl_0).ln().max(0.0) / self.slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A statistic whose maxima are known: independent exponential numbers exceed h with e^-h.
    #[test]
    fn the_limit_of_exponential_numbers_is_the_logarithm_of_their_arl() {
        let mut seed = 1_u64;
        let mut exponential = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            -(((seed >> 11) as f64 + 0.5) / (1_u64 << 53) as f64).ln()
        };
        let tail = Tail::of((0..400_000).map(|_| exponential())).expect("they are enough");
        let (found, exact) = (tail.limit(1e7), 1e7_f64.ln());
        // Above the exact limit, for the slope is taken at its lower end: 16 % of 7.8 nats.
        assert!(found > exact && found < exact + 2.5, "{found} against {exact}");
    }

    #[test]
    fn a_short_run_makes_no_limit() {
        let error = Tail::of((0..1000).map(f64::from)).unwrap_err();
        assert_eq!(error, TailError::TooFew { samples: 1000, needed: 120_000 });
    }
}
