//! Quantisation: a sensor shows whole steps of its resolution (encoder counts, converter bits).
//!
//! The nearest step; its derivative is that of the quantity itself, as for the mean of a
//! quantised signal that moves over many steps: the true one, zero but for jumps, tells a fit
//! nothing. `[sensors]` has the steps of the signals T and I_m of a controlled drive.

use drivescope_numerics::Real;

use super::law::{ActsOn, Effect, Info, Outputs, OwnState, Parameter, Variable, View};

/// Adding and taking away 1.5 x 2^52 rounds to a whole number, in any instruction set.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// Below this many steps it does; beyond, a step is finer than a rounding error or nearly so.
const MOST_STEPS: f64 = 1e15;

/// Shown speed, current and position in whole steps; 0 for no step.
pub struct Quantisation;

/// The nearest whole number of steps.
#[inline(always)]
fn quantised<R: Real>(y: R, step: R) -> R {
    let count = y.value() / step.value();
    let whole = ((count + ROUNDER) - ROUNDER) * step.value();
    let there = (step.value() > 0.0) & (count.abs() < MOST_STEPS);
    y + R::constant(if there { whole - y.value() } else { 0.0 })
}

impl Effect<3, 0> for Quantisation {
    const INFO: Info = Info {
        fails_over: &[Variable::Omega],
        acts_on: &[ActsOn::Sensor],
        excludes: &["quantisation"],
        nulls: &[("q_omega", 0.0), ("q_i", 0.0), ("q_theta", 0.0)],
        unweighed: Some(
            "the steps of a sensor are read off its values, not fitted: they are part of the noise",
        ),
        ..Info::new(
            "quantisation",
            "shown: the nearest multiple of q_omega, q_i, q_theta",
            "a residual within half a step, as noise where the signal moves over many",
        )
    };
    const PARAMETERS: [Parameter; 3] = [
        Parameter {
            name: "q_omega",
            unit: "rad/s",
            nominal: 0.1,
            range: (0.0, f64::INFINITY),
            description: "step of the speed that is shown, 0 for none",
        },
        Parameter {
            name: "q_i",
            unit: "A",
            nominal: 0.005,
            range: (0.0, f64::INFINITY),
            description: "step of the current that is shown, 0 for none",
        },
        Parameter {
            name: "q_theta",
            unit: "rad",
            nominal: 0.001,
            range: (0.0, f64::INFINITY),
            description: "step of the position that is shown, 0 for none",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn sense<R: Real>([q_omega, q_i, q_theta]: [R; 3], _: [R; 0], _: &View<R>, y: &mut Outputs<R>) {
        y.omega = quantised(y.omega, q_omega);
        y.i = quantised(y.i, q_i);
        y.theta = quantised(y.theta, q_theta);
    }

    fn affine_beyond(_: [f64; 3]) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters};
    use drivescope_numerics::Dual;

    #[test]
    fn each_sensor_shows_whole_steps_of_its_own() {
        let p =
            parameters::<Quantisation, 3, 0>([("q_i", 0.05), ("q_theta", 0.0), ("q_omega", 2.0)]);
        for sign in [1.0, -1.0] {
            let mut y = Outputs { i: 1.32 * sign, omega: 6.9 * sign, theta: 0.4321 * sign };
            Quantisation::sense(p, [], &AT, &mut y);
            assert_same(y.i, 1.3 * sign);
            assert_same(y.omega, 6.0 * sign);
            assert_eq!(y.theta, 0.4321 * sign, "no step, no rounding");
        }
    }

    #[test]
    fn the_slope_is_that_of_the_mean() {
        let shown = quantised(Dual::<1> { v: 6.9, d: [3.0] }, Dual::constant(2.0));
        assert_eq!((shown.v, shown.d), (6.0, [3.0]));
        // A step far below the rounding error of the value changes nothing.
        assert_eq!(quantised(1.0, 1e-300), 1.0);
    }
}
