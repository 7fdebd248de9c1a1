//! What a threshold is: a band in which a healthy residual lies, sample by sample.

use drivescope_numerics::normal_quantile;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::data::{Data, DataError};

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

/// Constant thresholds: mean +- t_beta std of a healthy residual.
///
/// Source: K. Patan and T. Parisini, J. Process Control 15 (2005), 67-79.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantThreshold {
    /// Mean of the healthy residual, output unit.
    pub mean: f64,
    /// Standard deviation of the healthy residual, output unit.
    pub deviation: f64,
    /// Samples of the design set, run-up excluded.
    pub samples: usize,
}

impl ConstantThreshold {
    /// Designs the thresholds on a healthy residual (the output of `healthy`) from `run_up` on.
    pub fn design(healthy: &Data, run_up: usize) -> Result<Self, DataError> {
        healthy.require_samples(run_up + 2, "the design of a threshold after its run-up")?;
        let values = healthy.judged(healthy.output().values, run_up);
        let (mean, deviation) = mean_and_deviation(&values);
        Ok(Self { mean, deviation, samples: values.len() })
    }

    /// The band at a significance level.
    pub fn band(&self, confidence: Confidence) -> Band {
        let half = confidence.t_beta() * self.deviation;
        Band { lower: self.mean - half, upper: self.mean + half }
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
    use crate::data::Column;
    use crate::testing::noise;

    #[test]
    fn beta_of_healthy_samples_lies_outside() {
        let mut values = vec![1e6; 100];
        values.extend(noise(20_000, 1).iter().map(|e| 3.0 * e - 7.0));
        let column = Column { name: "r", values: &values };
        let healthy = Data::new(vec![column], column).unwrap();
        let design = ConstantThreshold::design(&healthy, 100).unwrap();
        assert_eq!(design.samples, 20_000);
        for beta in [0.05, 0.01] {
            let band = design.band(Confidence::new(beta).unwrap());
            let fresh = noise(20_000, 2);
            let outside = fresh.iter().filter(|e| band.is_exceeded_by(3.0 * **e - 7.0)).count();
            // Three standard deviations of a binomial share.
            let spread = 3.0 * (beta * (1.0 - beta) / 20_000.0).sqrt();
            assert!((outside as f64 / 20_000.0 - beta).abs() < spread, "{outside} at {beta}");
        }
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(Band { lower: -1.0, upper: 1.0 }.is_exceeded_by(f64::NAN));
        assert_eq!(Confidence::new(1.5), Err(ConfidenceError { beta: 1.5 }));
        let values = [1.0, 2.0, 3.0];
        let column = Column { name: "r", values: &values };
        let data = Data::new(vec![column], column).unwrap();
        let error = ConstantThreshold::design(&data, 2).unwrap_err();
        assert!(matches!(error, DataError::TooFew { needed: 4, samples: 3, .. }));
    }
}
