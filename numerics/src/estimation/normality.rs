//! Normality of a residual, and the normal quantile that bands are made of.
//!
//! D'Agostino and Pearson's omnibus test K^2 = Z(skewness)^2 + Z(kurtosis)^2, chi-square with
//! two degrees of freedom. Unlike the Jarque-Bera statistic, whose kurtosis part still misses
//! its limit distribution at thousands of samples, both parts are corrected for the sample size.
//! Sources: R. B. D'Agostino, Biometrika 57 (1970), 679-681 (skewness); F. J. Anscombe and
//! W. J. Glynn, Biometrika 70 (1983), 227-234 (kurtosis). Correlated samples tell less: sample
//! skewness and kurtosis of a normal process vary as those of n / sum rho_j^3 and n / sum rho_j^4
//! independent samples, sums over all lags of both signs (I. N. Lobato and C. Velasco, Econometric
//! Theory 20 (2004), 671-689), and these numbers take the place of n.

use statrs::distribution::{ContinuousCDF, Normal};

/// Fewest samples for which the approximation of the kurtosis' distribution holds.
const FEWEST: f64 = 20.0;
/// The sum of rho_j^3 is positive for every process; its estimate is kept from zero.
const LEAST: f64 = 0.1;

/// Outcome of the omnibus test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normality {
    /// Third standardised moment; 0 for a normal distribution.
    pub skewness: f64,
    /// Fourth standardised moment less 3; 0 for a normal distribution.
    pub excess_kurtosis: f64,
    /// K^2, the test statistic.
    pub statistic: f64,
    /// Probability of a larger K^2 if the residual is normal.
    pub p_value: f64,
}

/// Tests whether values can be normally distributed, given their autocorrelation at lags 1, 2, ...
/// as far as it matters (none: independent). `None` below 20 values or what 20 independent ones
/// would tell, or if they do not vary or are not finite.
pub fn omnibus_normality(values: &[f64], autocorrelation: &[f64]) -> Option<Normality> {
    let n = values.len() as f64;
    let worth = |power: i32| {
        let sum: f64 = autocorrelation.iter().map(|rho| rho.powi(power)).sum();
        n / (1.0 + 2.0 * sum).max(LEAST)
    };
    let [n_skewness, n_kurtosis] = [worth(3), worth(4)];
    if n_skewness.min(n_kurtosis) < FEWEST {
        return None;
    }
    let mean = values.iter().sum::<f64>() / n;
    let moment = |power: i32| values.iter().map(|x| (x - mean).powi(power)).sum::<f64>() / n;
    let variance = moment(2);
    if !(variance.is_finite() && variance > 0.0) {
        return None;
    }
    let skewness = moment(3) / variance.powf(1.5);
    let kurtosis = moment(4) / (variance * variance);
    let statistic =
        skewness_score(skewness, n_skewness).powi(2) + kurtosis_score(kurtosis, n_kurtosis).powi(2);
    // The tail of a chi-square with two degrees of freedom is an exponential.
    let p_value = (-0.5 * statistic).exp();
    Some(Normality { skewness, excess_kurtosis: kurtosis - 3.0, statistic, p_value })
}

/// Two-sided quantile t of the standard normal: P(|z| > t) = `beta`; 1.96 for 0.05.
/// NaN if `beta` is not within (0, 1).
pub fn normal_quantile(beta: f64) -> f64 {
    if beta > 0.0 && beta < 1.0 { -Normal::standard().inverse_cdf(0.5 * beta) } else { f64::NAN }
}

/// D'Agostino (1970): a Johnson S_U transform of the sample skewness.
fn skewness_score(skewness: f64, n: f64) -> f64 {
    let y = skewness * ((n + 1.0) * (n + 3.0) / (6.0 * (n - 2.0))).sqrt();
    let fourth = 3.0 * (n * n + 27.0 * n - 70.0) * (n + 1.0) * (n + 3.0)
        / ((n - 2.0) * (n + 5.0) * (n + 7.0) * (n + 9.0));
    let w2 = (2.0 * (fourth - 1.0)).sqrt() - 1.0;
    let delta = 1.0 / (0.5 * w2.ln()).sqrt();
    let alpha = (2.0 / (w2 - 1.0)).sqrt();
    delta * (y / alpha).asinh()
}

/// Anscombe and Glynn (1983): a cube-root transform of the sample kurtosis.
fn kurtosis_score(kurtosis: f64, n: f64) -> f64 {
    let expected = 3.0 * (n - 1.0) / (n + 1.0);
    let variance = 24.0 * n * (n - 2.0) * (n - 3.0) / ((n + 1.0).powi(2) * (n + 3.0) * (n + 5.0));
    let x = (kurtosis - expected) / variance.sqrt();
    let skew = 6.0 * (n * n - 5.0 * n + 2.0) / ((n + 7.0) * (n + 9.0))
        * (6.0 * (n + 3.0) * (n + 5.0) / (n * (n - 2.0) * (n - 3.0))).sqrt();
    let a = 6.0 + 8.0 / skew * (2.0 / skew + (1.0 + 4.0 / (skew * skew)).sqrt());
    let shape = 2.0 / (9.0 * a);
    let ratio = (1.0 - 2.0 / a) / (1.0 + x * (2.0 / (a - 4.0)).sqrt());
    (1.0 - shape - ratio.cbrt()) / shape.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reference is printed to ten digits.
    const REFERENCE: f64 = 1e-9;

    const STATISTIC: f64 = 5.898_778_157_231_026_5;
    const P_VALUE: f64 = 0.052_371_691_163_285_11;

    /// Reference values above: scipy 1.17 `stats.normaltest` on the same series.
    fn series() -> Vec<f64> {
        (0..60).map(|k| f64::from((k * k * 7 + k * 3) % 31).powf(1.5)).collect()
    }

    #[test]
    fn equals_scipy() {
        let outcome = omnibus_normality(&series(), &[]).unwrap();
        assert!((outcome.statistic / STATISTIC - 1.0).abs() < REFERENCE, "{}", outcome.statistic);
        assert!((outcome.p_value / P_VALUE - 1.0).abs() < REFERENCE, "{}", outcome.p_value);
    }

    #[test]
    fn quantiles_are_the_tabulated_ones() {
        assert!((normal_quantile(0.05) - 1.959_963_984_540_054).abs() < REFERENCE);
        assert!((normal_quantile(0.01) - 2.575_829_303_548_901).abs() < REFERENCE);
        assert!(normal_quantile(0.0).is_nan() && normal_quantile(1.5).is_nan());
    }

    #[test]
    fn normal_scores_pass_and_uniform_ones_fail() {
        let n = 1000;
        let score = |k: usize| normal_quantile(2.0 * (k as f64 + 0.5) / (2.0 * n as f64));
        let symmetric: Vec<f64> = (0..n).flat_map(|k| [score(k), -score(k)]).collect();
        assert!(omnibus_normality(&symmetric, &[]).unwrap().p_value > 0.5);
        let uniform: Vec<f64> = (0..n).map(|k| k as f64).collect();
        assert!(omnibus_normality(&uniform, &[]).unwrap().p_value < 1e-6);
    }

    #[test]
    fn correlation_alone_does_not_look_abnormal() {
        // e(k) = 0.9 e(k-1) + w(k) with normal w: 400 series of 1000 values.
        const SERIES: usize = 400;
        let mut seed = 1_u64;
        let mut normal = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let uniform = ((seed >> 11) as f64 + 0.5) / (1_u64 << 53) as f64;
            Normal::standard().inverse_cdf(uniform)
        };
        let mut refused = [0; 2];
        for _ in 0..SERIES {
            let mut e = 0.0;
            let mut values = || {
                e = 0.9 * e + normal();
                e
            };
            for _ in 0..100 {
                values();
            }
            let values: Vec<f64> = (0..1000).map(|_| values()).collect();
            let whiteness = crate::ljung_box(&values, 50).unwrap();
            for (refused, correlation) in
                refused.iter_mut().zip([whiteness.autocorrelation.as_slice(), &[]])
            {
                let outcome = omnibus_normality(&values, correlation).unwrap();
                *refused += usize::from(outcome.p_value < 0.05);
            }
        }
        // 5 % of 400 are 20 +- 4.4; as independent, more than a quarter would be refused.
        let [corrected, independent] = refused;
        assert!((4..=36).contains(&corrected) && independent > SERIES / 4, "{refused:?}");
    }

    #[test]
    fn what_has_no_meaning_is_none() {
        assert_eq!(omnibus_normality(&[1.0; 50], &[]), None);
        assert_eq!(omnibus_normality(&series()[..19], &[]), None);
    }
}
