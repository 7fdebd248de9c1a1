//! A band about a healthy residual that never moves, as it is stored.

use serde::{Deserialize, Serialize};

use crate::data::{Data, DataError};
use crate::threshold::{Band, Confidence, mean_and_deviation};

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
    fn too_little_data_is_refused() {
        let values = [1.0, 2.0, 3.0];
        let column = Column { name: "r", values: &values };
        let data = Data::new(vec![column], column).unwrap();
        let error = ConstantThreshold::design(&data, 2).unwrap_err();
        assert!(matches!(error, DataError::TooFew { needed: 4, samples: 3, .. }));
    }
}
