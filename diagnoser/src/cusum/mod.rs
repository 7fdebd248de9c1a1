//! Cumulative sums of whitened innovations, two-sided: the test of Page for a shift of the mean.
//!
//! g+ = max(0, g+ + e - kappa),   g- = max(0, g- - e - kappa),   declared while one exceeds h
//!
//! with e the innovations of r - y_e ([`Whitening`]). Source: E. S. Page, Biometrika 41 (1954),
//! 100-115. The threshold h is designed for a mean number of samples between false alarms by the
//! approximation of D. Siegmund, Sequential Analysis (1985): of one side
//! (e^(2 kappa b) - 2 kappa b - 1) / (2 kappa^2), b = h + 1.166, for independent normal e; two
//! sides alarm twice as often. What it does on correlated or other than normal innovations is
//! counted on healthy runs, not assumed.

mod lanes;
mod whitening;

use drivescope_numerics::elementary::exp;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use lanes::{CusumLanes, CusumStep};
pub use whitening::Whitening;

/// Mean excess over a boundary of a sum of normal steps: 2 x 0.583.
const EXCESS: f64 = 1.166;
/// A sum stops growing at this many thresholds, so that it comes down once a fault is over.
const MOST: f64 = 2.0;

/// Why there is no such test.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CusumError {
    /// Nothing to whiten.
    #[error("what the bands leave of the healthy residual does not vary, or is too short")]
    NoInnovations,
}

/// The test without its settings: what is learned of healthy data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cusum {
    /// From r - y_e to innovations.
    pub whitening: Whitening,
}

impl Cusum {
    /// Learns the whitening, of that order, from r - y_e of a healthy run after its run-up.
    ///
    /// # Errors
    /// [`CusumError`].
    pub fn learn(healthy: &[f64], order: usize) -> Result<Self, CusumError> {
        let whitening = Whitening::fit(healthy, order).ok_or(CusumError::NoInnovations)?;
        Ok(Self { whitening })
    }
}

/// The threshold h for that mean number of samples between false alarms and that drift kappa, both
/// in standard deviations of the innovations.
pub fn threshold_for(arl_0: f64, kappa: f64) -> f64 {
    let between = |h: f64| {
        let twice = 2.0 * kappa * (h + EXCESS);
        (exp(twice) - 1.0 - twice) / (4.0 * kappa * kappa)
    };
    let (mut low, mut high) = (0.0, 1.0);
    while between(high) < arl_0 {
        high *= 2.0;
    }
    // 60 halvings are more than a number has digits.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if between(middle) < arl_0 { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::noise;

    /// The average run lengths of tables of the two-sided test for kappa = 0.5.
    #[test]
    fn thresholds_are_those_of_the_tables() {
        for (h, arl) in [(4.0, 168.0), (5.0, 465.0)] {
            assert!((threshold_for(arl, 0.5) - h).abs() < 0.02, "{}", threshold_for(arl, 0.5));
        }
    }

    #[test]
    fn false_alarms_come_as_often_as_designed() {
        let (arl_0, samples) = (500.0, 400_000);
        let whitening = Whitening { mean: 0.0, a: vec![], deviation: 1.0 };
        let settings = ([threshold_for(arl_0, 0.5); 4], [0.5; 4]);
        let e: [Vec<f64>; 4] = std::array::from_fn(|l| noise(samples, 3 + l as u64));
        let mut lanes = CusumLanes::new(&Cusum { whitening }, settings.0, settings.1);
        let mut alarms = 0;
        for k in 0..samples {
            let step = lanes.step(&std::array::from_fn(|l| e[l][k]));
            for (l, _) in step.exceeds.iter().enumerate().filter(|(_, exceeds)| **exceeds == 1) {
                alarms += 1;
                lanes.restart(l);
            }
        }
        let found = (4 * samples) as f64 / f64::from(alarms);
        // 3200 alarms: two per cent, and some of the approximation.
        assert!((found / arl_0 - 1.0).abs() < 0.1, "{found}");
    }

    #[test]
    fn a_shift_is_declared_and_forgotten() {
        let whitening = Whitening { mean: 5.0, a: vec![-0.5], deviation: 2.0 };
        let h = threshold_for(1e5, 0.5);
        let mut lanes = CusumLanes::<2>::new(&Cusum { whitening }, [h; 2], [0.5; 2]);
        let mut declared = Vec::new();
        for k in 0..300 {
            // Lane 1 shifts by six standard deviations of e, downwards, for a hundred samples.
            let shift = if (100..200).contains(&k) { -24.0 } else { 0.0 };
            let step = lanes.step(&[5.0, 5.0 + shift]);
            assert_eq!(step.exceeds[0], 0);
            if step.exceeds[1] == 1 {
                declared.push(k);
            }
        }
        assert!(declared[0] >= 100 && declared[0] < 105, "{declared:?}");
        assert!(*declared.last().expect("some") < 250, "{declared:?}");
    }
}
