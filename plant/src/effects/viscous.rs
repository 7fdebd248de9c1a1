//! Viscous friction (22): torque B omega. `[motor] B_m` is the same law in the base drive.

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Torque B omega against the motion.
pub struct Viscous;

impl Effect<1, 0> for Viscous {
    const INFO: Info = Info {
        dissipates: true,
        fails_over: &[Variable::Omega],
        aliases: &["B_m", "iron_loss"],
        nulls: &[("B", 0.0)],
        ..Info::new("viscous", "torque = -B * omega", "omega, in proportion")
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "B",
        unit: "N m s/rad",
        nominal: 1e-5,
        range: (0.0, f64::INFINITY),
        description: "viscous friction on top of B_m",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([b]: [R; 1], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        sum.torque += b * at.omega;
    }

    fn affine_beyond(_: [f64; 1]) -> f64 {
        0.0
    }

    fn fastest([b]: [f64; 1], _: f64, inertia: f64) -> f64 {
        b / inertia
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_torque_is_proportional_to_speed() {
        let p = parameters::<Viscous, 1, 0>([("B", 3e-5)]);
        assert_same(shared::<Viscous, 1, 0>(p, [], AT).torque, 3e-5 * AT.omega);
    }
}
