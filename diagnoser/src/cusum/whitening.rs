//! From what the bands leave of a healthy residual to white innovations: an autoregressive filter.
//!
//! e(k) = [d(k) + a_1 d(k-1) + .. + a_p d(k-p)] / s, with a by Levinson's recursion on the
//! autocovariances of healthy data (G. Box, G. Jenkins, Time Series Analysis, appendix A3.2) and s the
//! standard deviation of what it leaves: e has variance 1 in health.

use serde::{Deserialize, Serialize};

/// The filter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Whitening {
    /// Mean of d in health, output unit.
    pub mean: f64,
    /// a_1 .. a_p.
    pub a: Vec<f64>,
    /// s, output unit.
    pub deviation: f64,
}

impl Whitening {
    /// The filter of that order for a healthy signal; nothing where it does not vary, or is not
    /// ten times as long as the filter.
    pub(super) fn fit(healthy: &[f64], order: usize) -> Option<Self> {
        if healthy.len() < 10 * order.max(1) {
            return None;
        }
        let n = healthy.len() as f64;
        let mean = healthy.iter().sum::<f64>() / n;
        let covariance: Vec<f64> = (0..=order)
            .map(|lag| {
                let pairs = healthy.iter().zip(&healthy[lag..]);
                pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / n
            })
            .collect();
        let (mut a, mut remainder) = (Vec::with_capacity(order), covariance[0]);
        for p in 1..=order {
            let ahead: f64 = a.iter().zip(covariance[..p].iter().rev()).map(|(a, c)| a * c).sum();
            let reflection = -(covariance[p] + ahead) / remainder;
            let before: Vec<f64> = a.clone();
            let reversed = before.iter().rev();
            a.iter_mut().zip(reversed).for_each(|(a, other)| *a += reflection * other);
            a.push(reflection);
            remainder *= 1.0 - reflection * reflection;
        }
        let deviation = remainder.sqrt();
        let usable = deviation.is_finite() && deviation > 0.0 && a.iter().all(|a| a.is_finite());
        usable.then_some(Self { mean, a, deviation })
    }

    /// How much of a constant shift of d, in standard deviations of e, stays in e: the sum of the
    /// filter.
    pub fn gain(&self) -> f64 {
        (1.0 + self.a.iter().sum::<f64>()) / self.deviation
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::noise;

    #[test]
    fn an_autoregression_is_found_again() {
        let e = noise(100_000, 5);
        let mut d = vec![0.0; e.len()];
        for k in 2..e.len() {
            d[k] = 1.2 * d[k - 1] - 0.5 * d[k - 2] + 3.0 * e[k];
        }
        d.iter_mut().for_each(|d| *d += 7.0);
        let found = Whitening::fit(&d, 3).expect("it varies");
        let exact = [-1.2, 0.5, 0.0];
        assert!(found.a.iter().zip(exact).all(|(a, b)| (a - b).abs() < 0.02), "{:?}", found.a);
        assert!((found.deviation - 3.0).abs() < 0.05 && (found.mean - 7.0).abs() < 0.2);
        assert!((found.gain() - 0.1).abs() < 0.01);
        assert!(Whitening::fit(&[1.0; 100], 3).is_none());
        assert!(Whitening::fit(&e[..20], 3).is_none());
    }
}
