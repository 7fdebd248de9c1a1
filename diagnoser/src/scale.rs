//! Standardised signals: (x - mean) / deviation.

use serde::{Deserialize, Serialize};

use crate::threshold::mean_and_deviation;

/// Mean and standard deviation that a signal is standardised by, in its unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scale {
    /// Mean of the estimation data.
    pub mean: f64,
    /// Standard deviation of the estimation data; positive.
    pub deviation: f64,
}

impl Scale {
    /// Scale of a signal that varies.
    pub(crate) fn of(values: &[f64]) -> Self {
        let (mean, deviation) = mean_and_deviation(values);
        Self { mean, deviation }
    }

    /// Whether it can be divided by.
    pub(crate) fn is_usable(&self) -> bool {
        self.mean.is_finite() && self.deviation.is_finite() && self.deviation > 0.0
    }

    #[inline]
    pub(crate) fn standardise(&self, x: f64) -> f64 {
        (x - self.mean) / self.deviation
    }

    #[inline]
    pub(crate) fn restore(&self, x: f64) -> f64 {
        self.mean + self.deviation * x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standardised_values_have_mean_zero_and_deviation_one() {
        let values = [1000.0, 1010.0, 1030.0, 1000.0];
        let scale = Scale::of(&values);
        let standard = values.map(|x| scale.standardise(x));
        let (mean, deviation) = mean_and_deviation(&standard);
        assert!(mean.abs() < 1e-12 && (deviation - 1.0).abs() < 1e-12);
        assert!((scale.restore(standard[2]) - 1030.0).abs() < 1e-9);
        assert!(!Scale::of(&[1.0, 1.0]).is_usable());
    }
}
