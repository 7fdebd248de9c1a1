//! The coordinate in which a parameter is searched, and its bounds from physics.
//!
//! What is above zero by nature (R, J, a Stribeck speed) is searched by its logarithm; what may
//! be zero (friction) or have either sign by its value over its scale, zero being a bound that
//! can be reached and left. A speed that a law has for its scale is no smaller than the slowest
//! speed at which the recordings dwell, and no larger than the largest (or than the file says):
//! nothing is known beyond.

use drivescope_plant::parameters::NamedParameter;

use crate::measured::{Measured, Output};

/// Farthest that a positive parameter may go from its start: this factor.
const FARTHEST: f64 = 1e4;
/// Longest step of a logarithm: a linearisation says little about a drive of seven times the
/// inertia.
const LONGEST: f64 = 2.0;
/// Samples over which a speed is averaged before it is looked at.
const AVERAGED: usize = 10;
/// Standard deviations of an averaged speed within which the shaft may be at rest.
const AT_REST: f64 = 5.0;
/// Samples within one octave of speed that are a dwell.
const DWELL: usize = 20;

/// How a parameter is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    logarithmic: bool,
    /// Unit of a linear coordinate.
    size: f64,
    /// Where the coordinate may go.
    pub(crate) reach: Reach,
}

/// Where a coordinate may go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reach {
    /// Least value.
    pub(crate) low: f64,
    /// Greatest value.
    pub(crate) high: f64,
    /// Longest step at once.
    pub(crate) longest: f64,
}

impl Scale {
    /// Of a parameter of the drive; `speeds` are the slowest and fastest that were recorded.
    pub(crate) fn of(parameter: &NamedParameter, speeds: (f64, f64)) -> Self {
        let (mut low, mut high) = parameter.range;
        if low <= 0.0 {
            return Self::linear(parameter.nominal, (low, high));
        }
        if ["rad/s", "m/s"].contains(&parameter.unit.as_str()) && speeds.0 < speeds.1 {
            // What the file says stands: it may come from elsewhere.
            low = low.max(speeds.0.min(parameter.value));
            high = high.min(speeds.1.max(parameter.value));
        }
        let value = parameter.value;
        let (low, high) = (low.max(value / FARTHEST).ln(), high.min(value * FARTHEST).ln());
        Self { logarithmic: true, size: 1.0, reach: Reach { low, high, longest: LONGEST } }
    }

    /// A coordinate in units of `size`, its value within a range.
    pub(crate) fn linear(size: f64, (low, high): (f64, f64)) -> Self {
        // A linear model is as good for long steps; a bad one is refused.
        let reach = Reach { low: low / size, high: high / size, longest: f64::INFINITY };
        Self { logarithmic: false, size, reach }
    }

    /// The coordinate of a value, within the bounds.
    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        let coordinate = if self.logarithmic { value.ln() } else { value / self.size };
        coordinate.clamp(self.reach.low, self.reach.high)
    }

    /// The value at a coordinate.
    pub(crate) fn value(&self, coordinate: f64) -> f64 {
        if self.logarithmic { coordinate.exp() } else { coordinate * self.size }
    }

    /// Whether the value there says nothing of how large the parameter may be: zero, or one of
    /// either sign.
    pub(crate) fn is_sizeless(&self, coordinate: f64) -> bool {
        !self.logarithmic && (self.reach.low < 0.0 || coordinate == 0.0)
    }

    /// d value / d coordinate.
    pub(crate) fn slope(&self, coordinate: f64) -> f64 {
        if self.logarithmic { coordinate.exp() } else { self.size }
    }
}

/// The slowest speed at which the recordings dwell, and the fastest, rad/s (m/s); an empty range
/// where no motion was measured.
pub(crate) fn recorded_speeds(recordings: &[Measured], noise: &[Vec<f64>]) -> (f64, f64) {
    let mut octaves = [0usize; OCTAVES];
    let mut fastest = 0.0_f64;
    for (measured, noise) in recordings.iter().zip(noise) {
        let rest = AT_REST * uncertainty(measured, noise);
        for speed in averaged(measured).filter(|speed| *speed > rest) {
            fastest = fastest.max(speed);
            let octave = speed.log2().floor() + (OCTAVES / 2) as f64;
            octaves[octave.clamp(0.0, (OCTAVES - 1) as f64) as usize] += 1;
        }
    }
    let slowest = octaves.iter().position(|samples| *samples >= DWELL);
    let slowest =
        slowest.map_or(f64::INFINITY, |octave| (octave as f64 - (OCTAVES / 2) as f64).exp2());
    (slowest, fastest)
}

/// Octaves of speed that are told apart, half of them below 1 rad/s.
const OCTAVES: usize = 80;

/// Magnitudes of the averaged speed.
fn averaged(measured: &Measured) -> impl Iterator<Item = f64> + '_ {
    let speed = measured.output(Output::Speed).map(|channel| &channel.values);
    let position = measured.output(Output::Position).map(|channel| &channel.values);
    let span = AVERAGED as f64 * measured.period_s;
    let of = move |k: usize| match (speed, position) {
        (Some(speed), _) => speed[k..k + AVERAGED].iter().sum::<f64>().abs() / AVERAGED as f64,
        (None, Some(x)) => (x[k + AVERAGED] - x[k]).abs() / span,
        (None, None) => f64::NAN,
    };
    (0..measured.len().saturating_sub(AVERAGED)).map(of)
}

/// Standard deviation of an averaged speed.
fn uncertainty(measured: &Measured, noise: &[f64]) -> f64 {
    let of = |output: Output| {
        measured.outputs.iter().zip(noise).find(|(channel, _)| channel.output == output)
    };
    let n = AVERAGED as f64;
    match (of(Output::Speed), of(Output::Position)) {
        (Some((_, sd)), _) => sd / n.sqrt(),
        (None, Some((_, sd))) => sd * 2f64.sqrt() / (n * measured.period_s),
        (None, None) => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{dr300, driven};

    #[test]
    fn coordinates_keep_to_what_is_possible() {
        let all = dr300().fitted();
        let of = |name: &str| all.iter().find(|it| it.name == name).expect("it is fitted");
        let speeds = (2.0, 300.0);
        let resistance = Scale::of(of("R"), speeds);
        assert!((resistance.value(resistance.coordinate(3.13)) - 3.13).abs() < 1e-12);
        assert!((resistance.slope(resistance.coordinate(3.13)) - 3.13).abs() < 1e-12);
        assert!(resistance.value(resistance.reach.low) > 0.0);
        let friction = Scale::of(of("coulomb.T_c"), speeds);
        assert_eq!(friction.value(friction.reach.low), 0.0);
        assert_eq!((friction.coordinate(0.016), friction.slope(0.5)), (1.0, 0.016));
        let slow = Scale::of(of("stribeck.omega_s"), speeds);
        assert!((slow.value(slow.coordinate(0.1)) - 2.0).abs() < 1e-12);
        let slow = Scale::of(of("stribeck.omega_s"), (20.0, 300.0));
        assert!((slow.value(slow.coordinate(0.1)) - 5.0).abs() < 1e-12, "the file says 5");
        let unmoved = Scale::of(of("stribeck.omega_s"), (f64::INFINITY, 0.0));
        assert!((unmoved.value(unmoved.coordinate(0.1)) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn passing_through_a_speed_is_no_dwell() {
        let drive = dr300();
        // Full speed, and after a reversal a slow stretch at some 30 rad/s.
        let u = |k: usize| [10.0, -10.0, -2.2][k / 1000];
        let measured = Measured::new(&drive, &driven(&drive, (0..3000).map(u).collect(), 0.001));
        let measured = measured.expect("it can be used");
        let slowest = measured.output(Output::Speed).expect("measured").values[2990].abs();
        let (low, high) = recorded_speeds(&[measured], &[vec![0.01, 0.01]]);
        assert!(low <= slowest && slowest < 2.0 * low, "{low} against {slowest}");
        assert!((140.0..170.0).contains(&high), "{high}");
    }
}
