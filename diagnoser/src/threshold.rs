//! What a threshold is: a band in which a healthy residual lies, sample by sample.

use drivescope_numerics::normal_quantile;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::memory::{Memory, MemoryError, Walk};

/// Lower and upper bound of a residual, in the unit of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower bound.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
}

impl Band {
    /// Whether a residual lies outside; NaN does.
    #[inline]
    pub fn is_exceeded_by(&self, residual: f64) -> bool {
        let inside = self.lower <= residual && residual <= self.upper;
        !inside
    }
}

/// A threshold as a running instance; its clone is its state.
pub trait Threshold: Clone {
    /// Forgets the past.
    fn reset(&mut self);

    /// Begins in the steady state of inputs held at `u`.
    fn settle(&mut self, u: &[f64]);

    /// Band at this sample; `u` holds the inputs of the same sample.
    fn band(&mut self, u: &[f64]) -> Band;
}

/// A band that never moves is a threshold.
impl Threshold for Band {
    fn reset(&mut self) {}

    fn settle(&mut self, _: &[f64]) {}

    #[inline]
    fn band(&mut self, _: &[f64]) -> Band {
        *self
    }
}

/// Nothing of it changes.
impl Memory for Band {
    fn walk(&mut self, _: &mut Walk) -> Result<(), MemoryError> {
        Ok(())
    }
}

/// A significance level outside (0, 1).
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("beta = {beta} is no significance level: it must lie between 0 and 1 (0.05, 0.01)")]
pub struct ConfidenceError {
    /// The value given.
    pub beta: f64,
}

/// Share of healthy samples expected outside, and the two-sided normal quantile t_beta for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Confidence {
    beta: f64,
    t_beta: f64,
}

impl Confidence {
    /// Checks that `beta` is within (0, 1); t_beta is 1.96 for 0.05 and 2.58 for 0.01.
    pub fn new(beta: f64) -> Result<Self, ConfidenceError> {
        let t_beta = normal_quantile(beta);
        if t_beta.is_finite() { Ok(Self { beta, t_beta }) } else { Err(ConfidenceError { beta }) }
    }

    /// Share of healthy samples expected outside.
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// Half width of the band in standard deviations.
    pub fn t_beta(&self) -> f64 {
        self.t_beta
    }
}

impl TryFrom<f64> for Confidence {
    type Error = ConfidenceError;

    fn try_from(beta: f64) -> Result<Self, ConfidenceError> {
        Self::new(beta)
    }
}

impl From<Confidence> for f64 {
    fn from(confidence: Confidence) -> f64 {
        confidence.beta
    }
}

/// Mean and standard deviation (divisor n - 1).
pub(crate) fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_refused() {
        assert!(Band { lower: -1.0, upper: 1.0 }.is_exceeded_by(f64::NAN));
        assert_eq!(Confidence::new(1.5), Err(ConfidenceError { beta: 1.5 }));
    }
}
