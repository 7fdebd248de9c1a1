//! What the values of a column say where its name leaves several meanings.

/// Temperatures of machines in degrees, from a cold hall to a hot winding.
const DEGREES: std::ops::RangeInclusive<f64> = 15.0..=120.0;
/// From one sample to the next a temperature moves by less than this share of its range ...
const SLOW: f64 = 0.02;
/// ... or of so many degrees, where the range is smaller (sensor noise).
const LEAST_RANGE: f64 = 5.0;

/// Mean square of a clock's steps over their squared mean, at most, and the steps that show it.
const STEADY: f64 = 1.5;
const CLOCK_STEPS: usize = 20;

/// A column's values at a glance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Look {
    /// Whether all values that are there are the same.
    pub(crate) constant: bool,
    /// Whether the values lie and move as a temperature in degrees does.
    pub(crate) like_degrees: bool,
    /// Whether the values rise steadily, as those of a clock do.
    pub(crate) like_clock: bool,
}

impl Look {
    /// Looks at the values; what is not finite is skipped.
    pub(crate) fn at(values: &[f64]) -> Look {
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut moved, mut steps, mut last) = (0.0, 0_usize, f64::NAN);
        let (mut rising, mut squares) = (true, 0.0);
        for value in values.iter().copied().filter(|value| value.is_finite()) {
            (min, max) = (min.min(value), max.max(value));
            if !last.is_nan() {
                moved += (value - last).abs();
                squares += (value - last).powi(2);
                rising &= value >= last;
                steps += 1;
            }
            last = value;
        }
        let inside = DEGREES.contains(&min) && DEGREES.contains(&max);
        let slow = moved <= SLOW * steps as f64 * (max - min).max(LEAST_RANGE);
        // Mean square over squared mean of the steps: 1 if all are alike, 2 if they are random.
        let steady = squares * steps as f64 <= STEADY * moved * moved;
        Look {
            constant: steps > 0 && min == max,
            like_degrees: inside && slow && steps > 0,
            like_clock: rising && steady && steps >= CLOCK_STEPS && max > min,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warming_winding_is_no_speed() {
        let of = |value: &dyn Fn(f64) -> f64| {
            Look::at(&(0..1000).map(|k| value(f64::from(k))).collect::<Vec<_>>())
        };
        assert!(of(&|k| 25.0 + 0.03 * k + 0.05 * (7.0 * k).sin()).like_degrees);
        assert!(of(&|_| 40.0).like_degrees && of(&|_| 40.0).constant);
        assert!(!of(&|k| 60.0 + 40.0 * (0.7 * k).sin()).like_degrees, "it swings");
        assert!(!of(&|k| 20.0 * (0.001 * k).sin()).like_degrees, "too cold");
        assert_eq!(Look::at(&[f64::NAN; 5]), Look::default());
    }

    #[test]
    fn a_clock_rises_steadily() {
        let of = |value: &dyn Fn(f64) -> f64| {
            Look::at(&(0..100).map(|k| value(f64::from(k))).collect::<Vec<_>>()).like_clock
        };
        assert!(of(&|k| 1297.0 + 0.01 * k + 0.002 * k.sin()));
        assert!(!of(&|k| k.sin()) && !of(&|_| 3.0) && !of(&|k| k.powi(4)));
    }
}
