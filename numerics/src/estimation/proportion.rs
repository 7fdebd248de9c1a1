//! How far a counted share may be from the true one.

/// Two-sided 95 % of a normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// The 95 % score interval of `hits` successes of `of` trials (E. B. Wilson, J. Am. Stat. Assoc.
/// 22 (1927), 209-212), as fractions; not a number where there are no trials.
pub fn wilson_95(hits: usize, of: usize) -> [f64; 2] {
    let n = of as f64;
    let p = hits as f64 / n;
    let shrink = 1.0 + Z * Z / n;
    let middle = (p + Z * Z / (2.0 * n)) / shrink;
    let half = Z / shrink * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    if of == 0 { [f64::NAN; 2] } else { [(middle - half).max(0.0), (middle + half).min(1.0)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_the_share_and_none_of_78_proves_no_more_than_five_per_cent() {
        let [low, high] = wilson_95(0, 78);
        assert!(low == 0.0 && (high - 0.0469).abs() < 1e-3, "{high}");
        let [low, high] = wilson_95(90, 100);
        assert!((low - 0.8256).abs() < 1e-3 && (high - 0.9448).abs() < 1e-3, "{low} {high}");
        assert!(wilson_95(0, 0).iter().all(|end| end.is_nan()));
    }
}
