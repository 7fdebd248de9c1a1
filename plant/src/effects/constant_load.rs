//! Constant load: a torque that is always there (a weight, a spring, an offset of the input).
//!
//! Sign: as the load T_l, positive against positive motion, J domega/dt = ... - T_0.

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// T_0 as a parameter of a drive, for those who ask for an offset in particular.
pub const OFFSET: &str = "constant_load.T_0";

/// Torque T_0 against positive motion, whatever the drive does.
pub struct ConstantLoad;

impl Effect<1, 0> for ConstantLoad {
    const INFO: Info = Info {
        fails_over: &[Variable::OmegaSign, Variable::Omega],
        aliases: &["asymmetric_friction"],
        nulls: &[("T_0", 0.0)],
        ..Info::new(
            "constant_load",
            "torque = -T_0",
            "an offset in both directions, whatever the speed",
        )
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "T_0",
        unit: "N m",
        nominal: 0.002,
        range: (f64::NEG_INFINITY, f64::INFINITY),
        description: "constant load, positive against positive motion",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([t_0]: [R; 1], _: [R; 0], _: &View<R>, sum: &mut Sum<R>) {
        sum.torque += t_0;
    }

    fn affine_beyond(_: [f64; 1]) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, parameters, shared};

    #[test]
    fn the_load_does_not_ask_for_the_motion() {
        let p = parameters::<ConstantLoad, 1, 0>([("T_0", -0.003)]);
        for direction in [1.0, 0.0, -1.0] {
            let at = View { omega: 7.0 * direction, direction, ..AT };
            assert_eq!(shared::<ConstantLoad, 1, 0>(p, [], at).torque, -0.003);
        }
    }
}
