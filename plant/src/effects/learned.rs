//! A learned curve: a torque, a voltage or a share of the flux over one variable, perhaps times the
//! sign of the motion or the current, by its values at knots.
//!
//! Between knots a cubic (Hermite) whose slope at a knot is that of the parabola through it and
//! its neighbours (one-sided at the ends): linear in the values, smooth at the knots, and a
//! value acts on four intervals only. Beyond the ends it keeps the end values, so that it adds
//! nothing that was never seen. Over the angle of a rotary drive it repeats every revolution.

use drivescope_numerics::Real;
use thiserror::Error;

use super::law::Views;

/// Fewest knots of a curve.
pub const FEWEST_KNOTS: usize = 2;
/// Most knots of a curve.
pub const MOST_KNOTS: usize = 64;
/// Adding and taking away 1.5 x 2^52 rounds to a whole number, in any instruction set.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// The variable that a curve goes over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Armature current, A.
    Current,
    /// Speed, rad/s (m/s).
    Speed,
    /// Position, rad (m).
    Position,
    /// Armature voltage or commanded force signal.
    Input,
    /// Time, s.
    Time,
    /// Magnitude of the current, A.
    CurrentMagnitude,
    /// Magnitude of the speed, rad/s (m/s).
    SpeedMagnitude,
}

impl Over {
    /// Every variable with its name in the drive file; those of a linear drive come last.
    pub const ALL: [(&'static str, Self); 10] = [
        ("omega", Self::Speed),
        ("i", Self::Current),
        ("theta", Self::Position),
        ("u", Self::Input),
        ("time", Self::Time),
        ("abs(i)", Self::CurrentMagnitude),
        ("abs(omega)", Self::SpeedMagnitude),
        ("abs(v)", Self::SpeedMagnitude),
        ("v", Self::Speed),
        ("x", Self::Position),
    ];
}

/// What multiplies a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Factor {
    /// Sign of the motion: the torque of a dry friction.
    Direction,
    /// Armature current, A: the voltage of a resistance.
    Current,
}

impl Factor {
    /// Every factor with its name in the drive file; that of a linear drive comes last.
    pub const ALL: [(&'static str, Self); 3] =
        [("sign(omega)", Self::Direction), ("i", Self::Current), ("sign(v)", Self::Direction)];
}

/// Why numbers are not the knots of a curve.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum KnotError {
    /// Too few or too many.
    #[error("{found} knots: give {FEWEST_KNOTS} to {MOST_KNOTS}")]
    Count {
        /// How many there are.
        found: usize,
    },
    /// A knot that is not finite or not beyond the one before it.
    #[error("{value} after {before}: knots are finite and increase")]
    Order {
        /// Number of the knot, from 0.
        number: usize,
        /// The knot.
        value: f64,
        before: f64,
    },
    /// Knots over more than the revolution after which the curve repeats.
    #[error("the knots span {span} rad: over the angle they stay below one revolution, 2 pi")]
    Revolution {
        /// From the first to the last, rad.
        span: f64,
    },
}

/// A curve without its values, which are the effect's parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    over: Over,
    times: Option<Factor>,
    /// The knots, and for a curve that repeats the first one a period on.
    knots: Vec<f64>,
    period: Option<f64>,
}

impl Curve {
    /// A curve over those knots; `period` is that after which it repeats, if it does.
    ///
    /// # Errors
    /// [`KnotError`] for knots that are too few or too many, do not increase, or do not fit
    /// into the period.
    pub fn new(over: Over, knots: &[f64], period: Option<f64>) -> Result<Self, KnotError> {
        let found = knots.len();
        if !(FEWEST_KNOTS..=MOST_KNOTS).contains(&found) {
            return Err(KnotError::Count { found });
        }
        let before = |k: usize| if k == 0 { f64::NEG_INFINITY } else { knots[k - 1] };
        let wrong = (0..found).find(|k| !(knots[*k].is_finite() && knots[*k] > before(*k)));
        if let Some(number) = wrong {
            let (value, before) = (knots[number], before(number));
            return Err(KnotError::Order { number, value, before });
        }
        let span = knots[found - 1] - knots[0];
        if period.is_some_and(|period| span >= period) {
            return Err(KnotError::Revolution { span });
        }
        let mut knots = knots.to_vec();
        knots.extend(period.map(|period| knots[0] + period));
        Ok(Self { over, times: None, knots, period })
    }

    /// The same times that factor.
    pub fn times(self, factor: Option<Factor>) -> Self {
        Self { times: factor, ..self }
    }

    /// Whether it is a dry friction where it is a torque: its sign is that of the motion.
    pub(super) fn is_dry(&self) -> bool {
        self.times == Some(Factor::Direction)
    }

    /// Whether it lies over time.
    pub(super) fn reads_time(&self) -> bool {
        self.over == Over::Time
    }

    /// Whether it gives the same as long as the shaft rests.
    pub(super) fn is_steady_at_rest(&self) -> bool {
        matches!(self.over, Over::Speed | Over::SpeedMagnitude | Over::Position)
            && self.times != Some(Factor::Current)
    }

    /// The curve's value in every lane; `p` are its values at the knots. The sign of the motion is
    /// left to who knows whether the shaft sticks.
    #[inline(always)]
    pub(super) fn value<R: Real, const N: usize>(
        &self,
        p: &[[R; N]],
        at: &Views<'_, R, N>,
    ) -> [R; N] {
        std::array::from_fn(|l| {
            let z = match self.over {
                Over::Current => at.i[l],
                Over::Speed => at.omega[l],
                Over::Position => at.theta[l],
                Over::Input => at.u[l],
                Over::Time => R::constant(at.time),
                Over::CurrentMagnitude => at.i[l].abs(),
                Over::SpeedMagnitude => at.omega[l].abs(),
            };
            let value = self.at(z, |k| p[k][l]);
            if self.times == Some(Factor::Current) { value * at.i[l] } else { value }
        })
    }

    /// The curve at `z`, from the values `v` at the knots.
    #[inline(always)]
    fn at<R: Real>(&self, z: R, v: impl Fn(usize) -> R) -> R {
        let last = self.knots.len() - 1;
        let (first, end) = (self.knots[0], self.knots[last]);
        let z = match self.period {
            Some(period) => {
                let turns = (z.value() - 0.5 * (first + end)) / period;
                z - R::constant(((turns + ROUNDER) - ROUNDER) * period)
            }
            None => z,
        };
        let low = R::select(z.value() < first, R::constant(first), z);
        let z = R::select(low.value() > end, R::constant(end), low);
        let beyond = self.knots[1..last].iter().filter(|knot| z.value() >= **knot).count();
        let k = beyond;
        // A curve that repeats has one knot more than values.
        let v = |k: usize| if self.period.is_some() { v(k % last) } else { v(k) };
        let width = |k: usize| self.knots[k + 1] - self.knots[k];
        let rise = |k: usize| (v(k + 1) - v(k)).scaled(1.0 / width(k));
        let slope = |k: usize| {
            let (before, after) = match (k, self.period.is_some()) {
                (0, false) => return rise(0),
                (k, false) if k == last => return rise(last - 1),
                (k, _) if k == 0 || k == last => (last - 1, 0),
                (k, _) => (k - 1, k),
            };
            let (h_before, h_after) = (width(before), width(after));
            let sum = 1.0 / (h_before + h_after);
            rise(before).scaled(h_after * sum) + rise(after).scaled(h_before * sum)
        };
        let h = width(k);
        let t = (z - R::constant(self.knots[k])).scaled(1.0 / h);
        let (v_0, v_1, m_0, m_1) = (v(k), v(k + 1), slope(k).scaled(h), slope(k + 1).scaled(h));
        // v_0 + t (m_0 + t (3 d - 2 m_0 - m_1 + t (m_0 + m_1 - 2 d))), d = v_1 - v_0.
        let d = v_1 - v_0;
        let cubic = m_0 + m_1 - d.scaled(2.0);
        let square = d.scaled(3.0) - m_0.scaled(2.0) - m_1;
        v_0 + t * (m_0 + t * (square + t * cubic))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use drivescope_numerics::Dual;
    use std::f64::consts::TAU;

    /// Rounding of values about one.
    const ROUNDING: f64 = 1e-14;

    fn at(curve: &Curve, values: &[f64], z: f64) -> f64 {
        curve.at(z, |k| values[k])
    }

    #[test]
    fn it_passes_through_its_values_and_keeps_them_beyond() {
        let curve = Curve::new(Over::Speed, &[-3.0, -1.0, 0.5, 2.0], None).expect("right knots");
        let values = [1.0, -2.0, 0.25, 4.0];
        for (knot, value) in [-3.0, -1.0, 0.5, 2.0].into_iter().zip(values) {
            assert!((at(&curve, &values, knot) - value).abs() < ROUNDING);
        }
        assert_eq!((at(&curve, &values, -9.0), at(&curve, &values, 9.0)), (1.0, 4.0));
    }

    /// A parabola, and so a straight line, is reproduced but for the end intervals.
    #[test]
    fn a_parabola_is_reproduced_inside_and_a_line_everywhere() {
        let knots = [-3.0, -1.0, 0.5, 2.0, 3.0];
        let curve = Curve::new(Over::Speed, &knots, None).expect("right knots");
        let parabola = |z: f64| 1.0 - 2.0 * z + 0.5 * z * z;
        let line = |z: f64| 1.0 - 2.0 * z;
        for k in 0..60 {
            let z = -2.99 + 0.1 * f64::from(k);
            assert!((at(&curve, &knots.map(line), z) - line(z)).abs() < 10.0 * ROUNDING, "{z}");
            if (-1.0..=2.0).contains(&z) {
                let apart = at(&curve, &knots.map(parabola), z) - parabola(z);
                assert!(apart.abs() < 10.0 * ROUNDING, "{z}");
            }
        }
    }

    #[test]
    fn over_the_angle_it_repeats_and_is_smooth_where_it_closes() {
        let knots: [f64; 8] = std::array::from_fn(|k| k as f64 * TAU / 8.0);
        let curve = Curve::new(Over::Position, &knots, Some(TAU)).expect("right knots");
        let values = knots.map(f64::sin);
        for z in [0.3, 2.0, 6.2, -0.1] {
            let here = at(&curve, &values, z);
            // Eight knots a period follow a sine to a hundredth.
            assert!((here - z.sin()).abs() < 0.01, "{z}: {here}");
            assert!((at(&curve, &values, z - 3.0 * TAU) - here).abs() < 10.0 * ROUNDING);
        }
        let slope = |z: f64| curve.at(Dual::<1>::parameter(z, 0), |k| Dual::constant(values[k])).d;
        let [before, after] = [slope(-1e-9)[0], slope(1e-9)[0]];
        assert!((before - after).abs() < 1e-7, "{before} and {after}");
    }

    #[test]
    fn the_derivative_with_respect_to_a_value_is_its_hat() {
        let curve = Curve::new(Over::Speed, &[0.0, 1.0, 2.0, 3.0], None).expect("right knots");
        let values = [1.0, 3.0, -2.0, 0.5];
        for (k, z) in (0..4).flat_map(|k| [0.2, 1.7, 2.9].map(|z| (k, z))) {
            let value = |j: usize| Dual::<1> { v: values[j], d: [f64::from(j == k)] };
            let unit: [f64; 4] = std::array::from_fn(|j| f64::from(j == k));
            let slope = curve.at(Dual::constant(z), value).d[0];
            assert!((slope - at(&curve, &unit, z)).abs() < ROUNDING, "value {k} at {z}");
        }
    }

    #[test]
    fn wrong_knots_are_told() {
        let error = |knots: &[f64], period| Curve::new(Over::Speed, knots, period).expect_err("");
        assert_eq!(error(&[1.0], None), KnotError::Count { found: 1 });
        assert_eq!(error(&[0.0; 65], None), KnotError::Count { found: 65 });
        let order = KnotError::Order { number: 2, value: 1.0, before: 2.0 };
        assert_eq!(error(&[0.0, 2.0, 1.0], None), order);
        assert!(matches!(error(&[f64::NAN, 2.0], None), KnotError::Order { number: 0, .. }));
        assert_eq!(error(&[0.0, 7.0], Some(TAU)), KnotError::Revolution { span: 7.0 });
    }
}
