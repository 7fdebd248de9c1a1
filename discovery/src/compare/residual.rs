//! What is left of the outputs: whether it is white, and whether it knows the input.
//!
//! The autocorrelation at lag l has the variance (1 + 2 sum_(k<l) rho_k^2) / n (Bartlett, 1946),
//! the correlation of two signals that do not know each other sum_k rho_k rho'_k / n: bands for
//! correlated samples, whose effective number is smaller than n.

use serde::Serialize;

/// Lags that are looked at, s, and how many at most.
const REACH_S: f64 = 0.3;
const LAGS: usize = 60;
/// Lags of the sums that the bands need.
const MEMORY: usize = 800;
/// Two-sided 95 % of a normal law.
const NORMAL_95: f64 = 1.96;
/// Share of the lags that may be outside of their bands by chance: 5 % are, and of 60 lags 12 %
/// in one of a hundred cases.
const BY_CHANCE: f64 = 0.12;

/// Correlations over lags with their 95 % bands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correlation {
    /// Lags, s; negative: the residual comes first.
    pub lags: Vec<f64>,
    /// The correlation at each.
    pub values: Vec<f64>,
    /// Half the width of the band at each.
    pub bands: Vec<f64>,
    /// Samples that are worth as much as independent ones.
    pub effective_samples: f64,
    /// Whether more lags are outside of their bands than chance puts there.
    pub correlated: bool,
}

impl Correlation {
    fn new(lags: Vec<f64>, values: Vec<f64>, bands: Vec<f64>, effective_samples: f64) -> Self {
        let beyond = values.iter().zip(&bands).filter(|(value, band)| value.abs() > **band);
        let correlated = beyond.count() as f64 > (BY_CHANCE * values.len() as f64).max(1.0);
        Self { lags, values, bands, effective_samples, correlated }
    }
}

/// Correlation of a residual with itself.
pub(super) fn autocorrelation(e: &[f64], period_s: f64) -> Correlation {
    let n = e.len() as f64;
    let lags = lags(e.len(), period_s);
    let rho = correlations(e, MEMORY.min(e.len() / 4));
    let mut bands = Vec::new();
    for lag in &lags {
        let before: f64 = rho.iter().take(*lag).skip(1).map(|r| r * r).sum();
        bands.push(NORMAL_95 * ((1.0 + 2.0 * before) / n).sqrt());
    }
    let values = lags.iter().map(|lag| rho.get(*lag).copied().unwrap_or(0.0)).collect();
    let effective = n / (1.0 + 2.0 * rho.iter().skip(1).map(|r| r * r).sum::<f64>());
    let times = lags.iter().map(|lag| *lag as f64 * period_s).collect();
    Correlation::new(times, values, bands, effective)
}

/// Correlation of a residual with the input, whose past is at positive lags.
pub(super) fn input_correlation(e: &[f64], u: &[f64], period_s: f64) -> Correlation {
    let n = e.len() as f64;
    let memory = MEMORY.min(e.len() / 4);
    let (rho_e, rho_u) = (correlations(e, memory), correlations(u, memory));
    let both: f64 = rho_e.iter().zip(&rho_u).skip(1).map(|(a, b)| a * b).sum();
    // A sum that noise makes small or negative would promise more than independent samples do.
    let effective = n / (1.0 + 2.0 * both).max(1.0);
    let band = NORMAL_95 / effective.sqrt();
    let (e, u) = (centred(e), centred(u));
    let size = (square(&e) * square(&u)).sqrt();
    let positive = lags(e.len(), period_s);
    let negative = positive.iter().rev().map(|lag| -(*lag as i64));
    let signed: Vec<i64> = negative.chain([0]).chain(positive.iter().map(|l| *l as i64)).collect();
    let at = |lag: i64| {
        let skip = lag.unsigned_abs() as usize;
        let (first, second) = if lag >= 0 { (&u, &e) } else { (&e, &u) };
        let sum: f64 = first.iter().zip(&second[skip..]).map(|(a, b)| a * b).sum();
        if size > 0.0 { sum / size } else { 0.0 }
    };
    let values: Vec<f64> = signed.iter().map(|lag| at(*lag)).collect();
    let times = signed.iter().map(|lag| *lag as f64 * period_s).collect();
    Correlation::new(times, values, vec![band; signed.len()], effective)
}

/// Up to [`LAGS`] lags, evenly spread up to [`REACH_S`].
fn lags(samples: usize, period_s: f64) -> Vec<usize> {
    let reach = ((REACH_S / period_s) as usize).clamp(1, (samples / 4).max(1));
    let step = reach.div_ceil(LAGS);
    (1..=reach / step).map(|k| k * step).collect()
}

fn centred(x: &[f64]) -> Vec<f64> {
    let mean = x.iter().sum::<f64>() / x.len().max(1) as f64;
    x.iter().map(|x| x - mean).collect()
}

fn square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

/// Correlations at lags 0 to `last`.
fn correlations(x: &[f64], last: usize) -> Vec<f64> {
    let x = centred(x);
    let size = square(&x);
    let at = |lag: usize| x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>();
    (0..=last).map(|lag| if size > 0.0 { at(lag) / size } else { 0.0 }).collect()
}

/// Time after which the autocorrelation has fallen to 1 / e, s.
pub(super) fn memory_s(e: &[f64], period_s: f64) -> f64 {
    let rho = correlations(e, MEMORY.min(e.len() / 4));
    let fallen = rho.iter().position(|rho| *rho < (-1.0f64).exp());
    fallen.unwrap_or(rho.len()) as f64 * period_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::gaussian;

    fn slow(seed: u64) -> Vec<f64> {
        let mut x = 0.0;
        gaussian(8000, seed)
            .into_iter()
            .map(|w| {
                x = 0.97 * x + w;
                x
            })
            .collect()
    }

    #[test]
    fn white_noise_is_white_and_slow_noise_is_not() {
        let hits = (0..40).filter(|seed| autocorrelation(&gaussian(8000, *seed), 1e-3).correlated);
        assert!(hits.count() <= 2);
        let found = autocorrelation(&slow(1), 1e-3);
        assert!(found.correlated && found.effective_samples < 1000.0, "{found:?}");
        assert!((memory_s(&slow(1), 1e-3) - 0.033).abs() < 0.012);
    }

    #[test]
    fn two_slow_signals_that_do_not_know_each_other_are_not_correlated() {
        // Bands for independent samples would be left in nearly every case.
        let hits = (0..40)
            .filter(|seed| input_correlation(&slow(*seed), &slow(100 + seed), 1e-3).correlated);
        assert!(hits.count() <= 8);
        let u = slow(7);
        let e: Vec<f64> =
            slow(8).iter().enumerate().map(|(k, w)| w + u[k.saturating_sub(20)]).collect();
        let found = input_correlation(&e, &u, 1e-3);
        assert!(found.correlated);
        let most = found.values.iter().copied().fold(0.0, f64::max);
        let at = found.values.iter().position(|value| *value == most).expect("it is there");
        assert!((found.lags[at] - 0.02).abs() < 2e-3, "{}", found.lags[at]);
    }
}
