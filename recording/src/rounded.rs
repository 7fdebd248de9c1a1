//! Numbers in sentences.

/// A number without the digits that rounding left behind: `15.245`, not `15.245000000000001`. Eight
/// digits tell one sample from the next in a day of milliseconds.
pub fn rounded(value: f64) -> String {
    const DIGITS: usize = 8;
    let text = format!("{value:.*e}", DIGITS - 1);
    text.parse::<f64>().map_or(text, |value| value.to_string())
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
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(rounded(value), text);
        }
    }
}
