//! Load friction: gears and screws rub in proportion to what they transmit (V over i).
//!
//! T = c |K i| sgn(omega), a level of dry friction that rises with the motor torque. Where the
//! drive turns one way under a torque of one sign it is a smaller K_m.

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Dry friction in proportion to the motor torque.
pub struct LoadFriction;

impl Effect<1, 0> for LoadFriction {
    const INFO: Info = Info {
        dissipates: true,
        dry: true,
        kinked: true,
        fails_over: &[Variable::Current, Variable::OmegaSign],
        aliases: &["K_m"],
        nulls: &[("c", 0.0)],
        // Of a motor whose torque is all but rubbed away no drive is made.
        possible: |values, _| values[0] < 0.9,
        ..Info::new(
            "load_friction",
            "torque = -c * abs(K_m * i) * sign(omega)",
            "i, a V with its sides turned by the sign of omega",
        )
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "c",
        unit: "1",
        nominal: 0.1,
        range: (0.0, 1.0),
        description: "friction over motor torque (1: it could not start itself)",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([c]: [R; 1], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        let level = c * at.drive.abs();
        sum.forward += level;
        sum.backward += level;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_level_follows_the_motor_torque_of_either_sign() {
        let p = parameters::<LoadFriction, 1, 0>([("c", 0.1)]);
        for drive in [0.078, -0.078] {
            let sum = shared::<LoadFriction, 1, 0>(p, [], View { drive, ..AT });
            assert_same(sum.forward, 0.0078);
            assert_same(sum.backward, 0.0078);
        }
    }
}
