//! Armature reaction: the armature's own field weakens that of the magnets, in proportion to
//! the current of either sign: K_m, K_e times 1 - c |i|.

use drivescope_numerics::Real;

use super::grid::has_flux;
use super::law::{ActsOn, Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Flux 1 - c |i| of the nominal flux, in both balances.
pub struct ArmatureReaction;

impl Effect<1, 0> for ArmatureReaction {
    const INFO: Info = Info {
        kinked: true,
        fails_over: &[Variable::Current],
        acts_on: &[ActsOn::Torque, ActsOn::Voltage],
        aliases: &["saturation"],
        excludes: &["armature_reaction"],
        nulls: &[("c", 0.0)],
        possible: |values, spans| has_flux(1.0 - values[0] * spans.current),
        ..Info::new("armature_reaction", "K_m, K_e times 1 - c |i|", "i, even, from zero on")
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "c",
        unit: "1/A",
        nominal: 0.02,
        range: (0.0, f64::INFINITY),
        description: "loss of flux over the current",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([c]: [R; 1], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        sum.flux -= c * at.i.abs();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_flux_falls_in_proportion_to_current_of_either_sign() {
        let p = parameters::<ArmatureReaction, 1, 0>([("c", 0.02)]);
        for i in [3.0, -3.0] {
            assert_same(shared::<ArmatureReaction, 1, 0>(p, [], View { i, ..AT }).flux, 0.94);
        }
    }
}
