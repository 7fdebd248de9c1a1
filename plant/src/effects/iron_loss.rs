//! Iron loss: the field of the magnets turns in the rotor's iron (Steinmetz, 1892).
//!
//! Hysteresis takes the same energy from every revolution, a torque k_h sgn(omega); eddy
//! currents take it in proportion to speed, a torque k_e omega. Both heat the machine:
//! k_h |omega| + k_e omega^2 goes to the winding as well, which is all that tells them from
//! Coulomb and viscous friction.

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Hysteresis and eddy-current torque, and their heat.
pub struct IronLoss;

impl Effect<2, 0> for IronLoss {
    const INFO: Info = Info {
        dissipates: true,
        dry: true,
        fails_over: &[Variable::Omega, Variable::OmegaSign, Variable::Temperature],
        aliases: &["coulomb", "viscous", "B_m"],
        nulls: &[("k_h", 0.0), ("k_e", 0.0)],
        ..Info::new(
            "iron_loss",
            "torque = -(k_h * sign(omega) + k_e * omega); heat = k_h * abs(omega) + k_e * omega^2",
            "sign of omega and omega, in proportion; the winding warms at speed without current",
        )
    };
    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "k_h",
            unit: "N m",
            nominal: 0.002,
            range: (0.0, f64::INFINITY),
            description: "hysteresis torque",
        },
        Parameter {
            name: "k_e",
            unit: "N m s/rad",
            nominal: 1e-5,
            range: (0.0, f64::INFINITY),
            description: "eddy-current torque over speed",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([k_h, k_e]: [R; 2], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        let eddy = k_e * at.omega;
        sum.forward += k_h;
        sum.backward += k_h;
        sum.torque += eddy;
        sum.heat += (k_h * at.direction + eddy) * at.omega;
    }

    fn affine_beyond(_: [f64; 2]) -> f64 {
        0.0
    }

    fn fastest([_, k_e]: [f64; 2], _: f64, inertia: f64) -> f64 {
        k_e / inertia
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn what_the_shaft_loses_warms_the_winding() {
        let p = parameters::<IronLoss, 2, 0>([("k_e", 1e-5), ("k_h", 0.002)]);
        for direction in [1.0, -1.0] {
            let at = View { omega: 7.0 * direction, direction, ..AT };
            let sum = shared::<IronLoss, 2, 0>(p, [], at);
            assert_eq!((sum.forward, sum.backward), (0.002, 0.002));
            assert_same(sum.torque, 1e-5 * 7.0 * direction);
            assert_same(sum.heat, 0.002 * 7.0 + 1e-5 * 49.0);
        }
    }
}
