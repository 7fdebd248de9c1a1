//! The state in which a recording begins, from its first samples.
//!
//! Three candidates, of which [`super::replay::start`] takes the one from which the model follows
//! the first samples best: a straight line through them, at its beginning (it averages the
//! noise); the first sample itself (right where the motion bends at once); and rest, where most
//! recordings begin. What of the line cannot be told from zero is zero.

use drivescope_numerics::Regression;
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;

use super::{has_current, position, speed};

/// Samples that the line goes through, and over which the candidates are judged.
pub(super) const FIRST: usize = 10;
/// Standard errors within which a value is taken as zero.
const ERRORS_OF_ZERO: f64 = 3.0;

/// Current A, speed rad/s (m/s), position rad (m) at the first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Start {
    /// Armature current; 0 where there is none.
    pub(crate) current: f64,
    pub(crate) speed: f64,
    pub(crate) position: f64,
}

/// A line at the first sample.
struct Line {
    value: f64,
    /// Change a sample.
    slope: f64,
    /// Standard error of the value, and of the slope.
    errors: (f64, f64),
}

/// A value that cannot be told from zero is zero.
fn unless_zero(value: f64, error: f64) -> f64 {
    if value.abs() <= ERRORS_OF_ZERO * error { 0.0 } else { value }
}

/// The line through the first samples; none where they hold holes.
fn line(values: &[f64]) -> Option<Line> {
    let values = &values[..values.len().min(FIRST)];
    let mut regression = Regression::new(2);
    for (k, value) in values.iter().enumerate() {
        regression.push([1.0, k as f64], *value);
    }
    let fit = regression.solve().ok()?;
    let n = values.len() as f64;
    let variance = if n > 2.0 { fit.sse / (n - 2.0) } else { 0.0 };
    // Inverse of the normal matrix of [1, k], k = 0 .. n - 1.
    let of_value = 2.0 * (2.0 * n - 1.0) / (n * (n + 1.0));
    let of_slope = 12.0 / (n * (n * n - 1.0));
    Some(Line {
        value: fit.parameters[0],
        slope: fit.parameters[1],
        errors: ((variance * of_value).sqrt(), (variance * of_slope).sqrt()),
    })
}

impl Start {
    /// The candidates for a recording of that drive. Without a speed column the position gives
    /// the speed; without a current column a turning drive has the current of (20) in steady
    /// state, (u - K_e omega) / R, and a resting one none.
    pub(super) fn candidates(drive: &Drive, recording: &Recording) -> [Self; 3] {
        let values = |name: &str| recording.signal(name).map(|signal| signal.values.as_slice());
        let first = |name: &str| values(name)?.first().copied().filter(|value| value.is_finite());
        let line_of = |name: &str| values(name).and_then(line);
        let (speed, position) = (speed(drive).0, position(drive).0);
        let along = line_of(position);
        let by_position = along
            .as_ref()
            .map_or(0.0, |line| unless_zero(line.slope, line.errors.1) / recording.period_s);
        let steady_current = |speed: f64| match (drive.motor.k_e, drive.motor.r) {
            (Some(k_e), Some(r)) if speed != 0.0 => (first("u").unwrap_or(0.0) - k_e * speed) / r,
            _ => 0.0,
        };
        let start = |current: Option<f64>, speed: f64, position: Option<f64>| Self {
            current: if has_current(drive) {
                current.unwrap_or_else(|| steady_current(speed))
            } else {
                0.0
            },
            speed,
            position: position.unwrap_or(0.0),
        };
        let fitted = |line: Line| unless_zero(line.value, line.errors.0);
        let line_speed = line_of(speed).map_or(by_position, fitted);
        let first_speed = first(speed).unwrap_or(by_position);
        [
            start(line_of("i").map(fitted), line_speed, along.map(|line| line.value)),
            start(first("i"), first_speed, first(position)),
            start(Some(0.0), 0.0, first(position)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use drivescope_recording::Signal;

    /// Name of a signal and its values over time.
    type Curve = (&'static str, fn(f64) -> f64);

    fn recording(columns: &[Curve]) -> Recording {
        let signals = columns.iter().map(|(name, of)| Signal {
            name: (*name).to_owned(),
            unit: String::new(),
            values: (0..100).map(|k| of(f64::from(k) * 0.01)).collect(),
        });
        Recording::new("r", 3.0, 0.01, signals.collect())
    }

    fn dr300() -> Drive {
        crate::drive_source::drive("dr300").expect("it is built in")
    }

    /// Ten samples of a line leave rounding alone.
    const ROUNDING: f64 = 1e-10;

    #[test]
    fn a_speed_follows_from_the_position() {
        let measured = recording(&[("theta", |t| 2.0 + 50.0 * t), ("u", |_| 6.0)]);
        let [start, ..] = Start::candidates(&dr300(), &measured);
        assert!((start.speed - 50.0).abs() < ROUNDING && (start.position - 2.0).abs() < ROUNDING);
        assert!((start.current - (6.0 - 0.0599 * 50.0) / 3.13).abs() < ROUNDING, "{start:?}");
    }

    #[test]
    fn what_is_measured_counts_and_rest_stays_rest() {
        let measured = recording(&[("omega", |t| 7.0 - t), ("i", |_| 0.5)]);
        let [start, first, rest] = Start::candidates(&dr300(), &measured);
        assert_eq!((first.speed, first.current, rest.speed), (7.0, 0.5, 0.0));
        assert!((start.speed - 7.0).abs() < ROUNDING && (start.current - 0.5).abs() < ROUNDING);
        // A motion that begins bent, as every start from rest does.
        let [start, ..] = Start::candidates(&dr300(), &recording(&[("omega", |t| 100.0 * t * t)]));
        assert_eq!(start, Start { current: 0.0, speed: 0.0, position: 0.0 });
    }
}
