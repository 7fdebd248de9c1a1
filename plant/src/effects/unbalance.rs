//! Unbalance: gravity pulls at the rotor's heavy side once a revolution (horizontal shaft).

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Its name, for those who ask whether gravity pulls in particular.
pub const WEIGHT: &str = "unbalance";

/// Torque a cos(theta) + b sin(theta); m g r = sqrt(a^2 + b^2).
pub struct Unbalance;

impl Effect<2, 0> for Unbalance {
    const INFO: Info = Info {
        rotary: true,
        fails_over: &[Variable::Theta],
        aliases: &["cogging"],
        nulls: &[("a", 0.0), ("b", 0.0)],
        ..Info::new(
            WEIGHT,
            "torque = -(a * cos(theta) + b * sin(theta))",
            "theta, once a revolution, at every speed and current",
        )
    };
    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "a",
            unit: "N m",
            nominal: 0.002,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            description: "cosine amplitude",
        },
        Parameter {
            name: "b",
            unit: "N m",
            nominal: 0.002,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            description: "sine amplitude",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([a, b]: [R; 2], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        let (sin, cos) = at.theta.sin_cos();
        sum.torque += a * cos + b * sin;
    }

    fn fastest([a, b]: [f64; 2], speed: f64, inertia: f64) -> f64 {
        super::cogging::rate(1.0, a.hypot(b), speed, inertia)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn the_heavy_side_pulls_once_a_revolution() {
        let p = parameters::<Unbalance, 2, 0>([("b", 0.003), ("a", 0.002)]);
        let torque = |theta: f64| shared::<Unbalance, 2, 0>(p, [], View { theta, ..AT }).torque;
        assert_eq!(torque(0.0), 0.002);
        assert_same(torque(FRAC_PI_2), 0.003);
        assert_same(torque(PI), -0.002);
    }
}
