//! Tachometer gain: the speed that is shown is (1 + g) omega.
//!
//! By algebra it is the base drive with other parameters: K_m, K_e, J, B_m and the friction
//! rescale. Only a measured position, or a parameter known from elsewhere, tells it.

use drivescope_numerics::Real;

use super::law::{ActsOn, Effect, Info, Outputs, OwnState, Parameter, Variable, View};

/// Shown speed omega (1 + g); the shaft itself is untouched.
pub struct TachoGain;

impl Effect<1, 0> for TachoGain {
    const INFO: Info = Info {
        fails_over: &[Variable::Omega],
        acts_on: &[ActsOn::Sensor],
        distorts: Some(Variable::Omega),
        aliases: &["K_e", "K_m", "J", "B_m"],
        nulls: &[("g", 0.0)],
        ..Info::new(
            "tacho_gain",
            "omega = omega * (1 + g)",
            "omega, in proportion; against a measured theta, not in i",
        )
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "g",
        unit: "1",
        nominal: 0.02,
        range: (-1.0, f64::INFINITY),
        description: "share by which too much is shown",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn sense<R: Real>([g]: [R; 1], _: [R; 0], _: &View<R>, y: &mut Outputs<R>) {
        y.omega *= R::one() + g;
    }

    fn affine_beyond(_: [f64; 1]) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters};

    #[test]
    fn the_shown_speed_alone_is_scaled() {
        let p = parameters::<TachoGain, 1, 0>([("g", 0.02)]);
        let mut y = Outputs { i: 1.3, omega: 7.0, theta: 0.4 };
        TachoGain::sense(p, [], &AT, &mut y);
        assert_eq!((y.i, y.theta), (1.3, 0.4));
        assert_same(y.omega, 7.14);
    }
}
