//! What a number may be.

/// Whether a value is finite and within the range.
pub(crate) fn possible(value: f64, (low, high): (f64, f64)) -> bool {
    value.is_finite() && low <= value && value <= high
}

/// A range in words, with the unit.
pub(crate) fn allowed((low, high): (f64, f64), unit: &str) -> String {
    let number = match (low, high) {
        (f64::NEG_INFINITY, f64::INFINITY) => "a finite number".to_owned(),
        (f64::MIN_POSITIVE, f64::INFINITY) => "a finite number above 0".to_owned(),
        (low, f64::INFINITY) => format!("a finite number of {low} or more"),
        (low, high) => format!("a number from {low} to {high}"),
    };
    if unit.is_empty() || unit == "1" { number } else { format!("{number} ({unit})") }
}
