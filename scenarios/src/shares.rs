//! Figures over many trials, with what chance leaves open of them.

use drivescope_numerics::wilson_95;
use serde::Serialize;

/// Standard deviations of a mean on either side of its 95 % interval.
const QUANTILE: f64 = 1.959_964;

/// A count of successes with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Share {
    /// Successes.
    pub hits: usize,
    /// Trials.
    pub of: usize,
    /// Their ratio.
    pub share: f64,
    /// Its 95 % score interval.
    pub interval: [f64; 2],
}

impl Share {
    /// Of `of` trials, `hits` successes.
    pub fn new(hits: usize, of: usize) -> Self {
        Self { hits, of, share: hits as f64 / of as f64, interval: wilson_95(hits, of) }
    }

    /// Of all trials together.
    pub fn pooled<'a>(shares: impl IntoIterator<Item = &'a Self>) -> Self {
        let add = |(hits, of), it: &Self| (hits + it.hits, of + it.of);
        let (hits, of) = shares.into_iter().fold((0, 0), add);
        Self::new(hits, of)
    }
}

/// Mean and spread of a figure over the seeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    pub mean: f64,
    /// 95 % interval of the mean, from the scatter of the seeds; not numbers for less than two.
    pub interval: [f64; 2],
    /// 5 and 95 % of the seeds lie below.
    pub range: [f64; 2],
    pub least: f64,
}

impl Spread {
    /// Over values of which there is at least one; not numbers otherwise.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        let at = |share: f64| {
            let place = (share * n.saturating_sub(1) as f64).round() as usize;
            sorted.get(place).copied().unwrap_or(f64::NAN)
        };
        let mean = sorted.iter().sum::<f64>() / n as f64;
        let squares: f64 = sorted.iter().map(|value| (value - mean).powi(2)).sum();
        let half = QUANTILE * (squares / (n as f64 * (n as f64 - 1.0))).sqrt();
        let interval = [mean - half, mean + half];
        Self { mean, interval, range: [at(0.05), at(0.95)], least: at(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_of_the_middle_nine_tenths() {
        let spread = Spread::of((0..=100).map(f64::from));
        assert_eq!((spread.mean, spread.range, spread.least), (50.0, [5.0, 95.0], 0.0));
        // Deviation 29.3 over the root of 101 values.
        assert!((spread.interval[1] - 50.0 - 1.96 * 2.915).abs() < 0.01, "{spread:?}");
        assert!(Spread::of([]).mean.is_nan() && Spread::of([1.0]).interval[0].is_nan());
    }
}
