//! Quadratic drag (a fan, windage): torque c omega |omega|.

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Torque in proportion to the square of the speed.
pub struct QuadraticDrag;

impl Effect<1, 0> for QuadraticDrag {
    const INFO: Info = Info {
        dissipates: true,
        fails_over: &[Variable::Omega],
        nulls: &[("c", 0.0)],
        ..Info::new("quadratic_drag", "torque = -c * omega * abs(omega)", "omega, curved")
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "c",
        unit: "N m s^2/rad^2",
        nominal: 1e-7,
        range: (0.0, f64::INFINITY),
        description: "drag coefficient",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([c]: [R; 1], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        sum.torque += c * at.omega * at.omega.abs();
    }

    fn fastest([c]: [f64; 1], speed: f64, inertia: f64) -> f64 {
        2.0 * c * speed / inertia
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_torque_goes_with_the_square_of_speed_and_against_it() {
        let p = parameters::<QuadraticDrag, 1, 0>([("c", 3e-7)]);
        for omega in [7.0, -7.0] {
            let sum = shared::<QuadraticDrag, 1, 0>(p, [], View { omega, ..AT });
            assert_same(sum.torque, 3e-7 * 49.0 * omega.signum());
        }
    }
}
