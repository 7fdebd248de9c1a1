//! Supply sag: the bus voltage falls with the current that the bridge takes from it.
//!
//! A bridge with duty u / V_0 takes the current i u / V_0 from a supply of resistance R_s, whose
//! voltage falls by R_s i u / V_0; the armature gets that times its duty:
//! u - s u^2 i, s = R_s / V_0^2. Where |u| is constant it is a greater R.

use drivescope_numerics::Real;

use super::law::{ActsOn, Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Voltage s u^2 i that the supply does not give.
pub struct SupplySag;

impl Effect<1, 0> for SupplySag {
    const INFO: Info = Info {
        electrical: true,
        fails_over: &[Variable::Limits, Variable::Current, Variable::Acceleration],
        acts_on: &[ActsOn::Voltage],
        aliases: &["R"],
        nulls: &[("s", 0.0)],
        ..Info::new(
            "supply_sag",
            "voltage = -s * u^2 * i; s = R_s / V_0^2",
            "i where u is great: R seems to rise at the limit of u",
        )
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "s",
        unit: "1/(V A)",
        nominal: 0.001,
        range: (0.0, f64::INFINITY),
        description: "resistance of the supply over the square of its voltage",
    }];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([s]: [R; 1], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        sum.voltage += s * at.u * at.u * at.i;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    /// A supply of 24 V and 0.5 ohm at half duty: 2 A of the armature are 1 A of the bus, whose
    /// 0.5 V are 0.25 V at the armature.
    #[test]
    fn the_sag_is_that_of_a_bus_behind_a_resistance() {
        let p = parameters::<SupplySag, 1, 0>([("s", 0.5 / (24.0 * 24.0))]);
        for u in [12.0, -12.0] {
            let at = View { u, i: 2.0, ..AT };
            assert_same(shared::<SupplySag, 1, 0>(p, [], at).voltage, 0.25);
        }
    }
}
