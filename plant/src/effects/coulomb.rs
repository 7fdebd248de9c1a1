//! Coulomb friction: T_c sgn(omega), and a shaft that sticks until the torque exceeds T_c.

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// The level as a parameter of a drive, for those who ask for dry friction in particular.
pub const LEVEL: &str = "coulomb.T_c";

/// Dry friction of a constant level.
pub struct Coulomb;

impl Effect<1, 0> for Coulomb {
    const INFO: Info = Info {
        basic: true,
        dissipates: true,
        dry: true,
        fails_over: &[Variable::OmegaSign],
        aliases: &["iron_loss"],
        nulls: &[("T_c", 0.0)],
        ..Info::new("coulomb", "torque = -T_c * sign(omega)", "sign of omega")
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "T_c",
        unit: "N m",
        nominal: 0.01,
        range: (0.0, f64::INFINITY),
        description: "Coulomb friction",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([t_c]: [R; 1], _: [R; 0], _: &View<R>, sum: &mut Sum<R>) {
        sum.forward += t_c;
        sum.backward += t_c;
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
    fn the_level_is_the_same_both_ways() {
        let p = parameters::<Coulomb, 1, 0>([("T_c", 0.016)]);
        let sum = shared::<Coulomb, 1, 0>(p, [], AT);
        assert_eq!((sum.forward, sum.backward), (0.016, 0.016));
    }
}
