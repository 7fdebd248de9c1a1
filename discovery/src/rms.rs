//! The size of a series.

/// Root of the mean square of what is finite, never 0: it divides.
pub(crate) fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for value in values.into_iter().filter(|value| value.is_finite()) {
        sum += value * value;
        count += 1.0;
    }
    (sum / count.max(1.0)).sqrt().max(1e-300)
}
