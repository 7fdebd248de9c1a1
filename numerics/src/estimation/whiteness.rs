//! Whiteness of a residual: autocorrelation and the Ljung-Box test.
//!
//! rho_k = sum e(t) e(t-k) / sum e(t)^2 of the centred residual,
//! Q = n (n + 2) sum_{k=1..m} rho_k^2 / (n - k), chi-square with m degrees of freedom if the
//! residual is white. Source: G. M. Ljung and G. E. P. Box, Biometrika 65 (1978), 297-303.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Outcome of a Ljung-Box test.
#[derive(Debug, Clone, PartialEq)]
pub struct Whiteness {
    /// Autocorrelation at lags 1 to m; 95 % of them lie within 1.96 / sqrt(n) if white.
    pub autocorrelation: Vec<f64>,
    /// Q, the test statistic.
    pub statistic: f64,
    /// Probability of a larger Q if the residual is white.
    pub p_value: f64,
}

/// Tests a residual over `lags` lags. `None` if there are not more samples than lags, no lag is
/// asked for, or the residual does not vary (or is not finite): whiteness then has no meaning.
pub fn ljung_box(residual: &[f64], lags: usize) -> Option<Whiteness> {
    let n = residual.len();
    if lags == 0 || n <= lags {
        return None;
    }
    let mean = residual.iter().sum::<f64>() / n as f64;
    let centred: Vec<f64> = residual.iter().map(|e| e - mean).collect();
    let power: f64 = centred.iter().map(|e| e * e).sum();
    if !(power.is_finite() && power > 0.0) {
        return None;
    }
    let autocorrelation: Vec<f64> = (1..=lags)
        .map(|lag| centred[lag..].iter().zip(&centred).map(|(a, b)| a * b).sum::<f64>() / power)
        .collect();
    let weighted: f64 = autocorrelation
        .iter()
        .enumerate()
        .map(|(index, rho)| rho * rho / (n - index - 1) as f64)
        .sum();
    let statistic = n as f64 * (n as f64 + 2.0) * weighted;
    let p_value = ChiSquared::new(lags as f64).ok()?.sf(statistic);
    Some(Whiteness { autocorrelation, statistic, p_value })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reference is printed to ten digits.
    const REFERENCE: f64 = 1e-9;

    const STATISTIC: f64 = 10.996_082_157_221_233;
    const P_VALUE: f64 = 0.051_457_718_120_714_924;

    /// A short deterministic series; the reference values above were computed with
    /// statsmodels 0.15 `acorr_ljungbox` on the same series.
    fn series() -> Vec<f64> {
        (0..60).map(|k| f64::from((k * k * 7 + k * 3) % 31)).collect()
    }

    #[test]
    fn equals_statsmodels() {
        let outcome = ljung_box(&series(), 5).unwrap();
        assert!((outcome.statistic / STATISTIC - 1.0).abs() < REFERENCE, "{}", outcome.statistic);
        assert!((outcome.p_value / P_VALUE - 1.0).abs() < REFERENCE, "{}", outcome.p_value);
    }

    #[test]
    fn a_filtered_residual_is_not_white() {
        let mut state = 0.0;
        let coloured: Vec<f64> = (0..500)
            .map(|k| {
                state = 0.9 * state + f64::from((k * 7919 + 13) % 101) - 50.0;
                state
            })
            .collect();
        assert!(ljung_box(&coloured, 20).unwrap().p_value < 1e-6);
    }

    #[test]
    fn what_has_no_meaning_is_none() {
        assert_eq!(ljung_box(&[1.0; 50], 5), None);
        assert_eq!(ljung_box(&series(), 60), None);
        assert_eq!(ljung_box(&series(), 0), None);
        assert_eq!(ljung_box(&[1.0, f64::NAN, 2.0, 0.0], 2), None);
    }
}
