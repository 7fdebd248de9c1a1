//! Magnetic saturation: the flux, and with it K_m and K_e, falls with the current.

use drivescope_numerics::Real;

use super::grid::has_flux;
use super::law::{ActsOn, Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Flux 1 / (1 + c i^2) of the nominal flux, in both balances.
pub struct Saturation;

impl Effect<1, 0> for Saturation {
    const INFO: Info = Info {
        fails_over: &[Variable::Current],
        acts_on: &[ActsOn::Torque, ActsOn::Voltage],
        aliases: &["armature_reaction"],
        excludes: &["saturation"],
        nulls: &[("c", 0.0)],
        possible: |values, spans| has_flux(1.0 / (1.0 + values[0] * spans.current.powi(2))),
        ..Info::new("saturation", "K_m, K_e times 1 / (1 + c i^2)", "i, even")
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "c",
        unit: "1/A^2",
        nominal: 0.02,
        range: (0.0, f64::INFINITY),
        description: "curvature of the flux over the current",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([c]: [R; 1], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        let loss = c * at.i * at.i;
        sum.flux -= loss / (R::one() + loss);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_flux_falls_with_current_of_either_sign() {
        let p = parameters::<Saturation, 1, 0>([("c", 0.02)]);
        for i in [2.0, -2.0] {
            let flux = shared::<Saturation, 1, 0>(p, [], View { i, ..AT }).flux;
            assert_same(flux, 1.0 / (1.0 + 0.02 * 4.0));
        }
    }
}
