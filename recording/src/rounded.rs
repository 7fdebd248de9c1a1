//! Numbers in sentences.

/// A number without the digits that rounding left behind: `15.245`, not `15.245000000000001`. Eight
/// digits tell one sample from the next in a day of milliseconds. Rows of zeros are a power of ten.
pub fn rounded(value: f64) -> String {
    rounded_to(8, value)
}

/// The same with at most so many digits.
pub fn rounded_to(digits: usize, value: f64) -> String {
    /// Magnitudes that are read without one.
    const PLAIN: std::ops::Range<f64> = 1e-6..1e15;
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    match text.parse::<f64>() {
        Ok(value) if PLAIN.contains(&value.abs()) || value == 0.0 || !value.is_finite() => {
            value.to_string()
        }
        Ok(value) => format!("{value:e}"),
        Err(_) => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_left_behind_is_not_told() {
        for (value, text) in [
            (15.245_000_000_000_001, "15.245"),
            (0.1 + 0.2, "0.3"),
            (86_399.999, "86399.999"),
            (0.001, "0.001"),
            (2.0, "2"),
            (-0.0, "-0"),
            (1e-9, "1e-9"),
            (0.000_005, "0.000005"),
            (-1e300, "-1e300"),
            (1e12, "1000000000000"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(rounded(value), text);
        }
        for (value, text) in [(151.9644, "152"), (1000.0, "1000"), (2.441e-5, "0.0000244")] {
            assert_eq!(rounded_to(3, value), text);
        }
    }
}
