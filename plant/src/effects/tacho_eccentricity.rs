//! Tachometer eccentricity: the speed that is shown ripples once a revolution.

use drivescope_numerics::Real;

use super::law::{ActsOn, Effect, Info, Outputs, OwnState, Parameter, Variable, View};

/// Shown speed omega (1 + a cos theta + b sin theta); the shaft itself is untouched.
pub struct TachoEccentricity;

impl Effect<2, 0> for TachoEccentricity {
    const INFO: Info = Info {
        rotary: true,
        fails_over: &[Variable::Theta, Variable::Omega],
        acts_on: &[ActsOn::Sensor],
        distorts: Some(Variable::Omega),
        nulls: &[("a", 0.0), ("b", 0.0)],
        ..Info::new(
            "tacho_eccentricity",
            "omega = omega * (1 + a * cos(theta) + b * sin(theta))",
            "theta, once a revolution, in proportion to omega, not in i",
        )
    };
    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "a",
            unit: "1",
            nominal: 0.005,
            range: (-1.0, 1.0),
            description: "cosine share",
        },
        Parameter {
            name: "b",
            unit: "1",
            nominal: 0.005,
            range: (-1.0, 1.0),
            description: "sine share",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn sense<R: Real>([a, b]: [R; 2], _: [R; 0], at: &View<R>, y: &mut Outputs<R>) {
        let (sin, cos) = at.theta.sin_cos();
        y.omega *= R::one() + a * cos + b * sin;
    }

    fn affine_beyond(_: [f64; 2]) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters};

    #[test]
    fn only_the_shown_speed_ripples() {
        let p = parameters::<TachoEccentricity, 2, 0>([("b", 0.01), ("a", 0.02)]);
        let shown = |theta: f64| {
            let mut y = Outputs { i: AT.i, omega: AT.omega, theta };
            TachoEccentricity::sense(p, [], &View { theta, ..AT }, &mut y);
            (y.i, y.omega / AT.omega)
        };
        assert_eq!(shown(0.0), (AT.i, 1.02));
        assert_same(shown(std::f64::consts::FRAC_PI_2).1, 1.01);
    }
}
