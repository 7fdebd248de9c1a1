//! Asymmetric friction: Coulomb and viscous friction differ by direction.
//!
//! With the half differences dT_c and dB_m, backward less forward, beside T_c and B_m:
//! forward T_c - dT_c and F_v+ = B_m - dB_m, backward T_c + dT_c and F_v- = B_m + dB_m.
//! Half differences do not change the means, so that T_c and B_m keep their meaning and all
//! four are identifiable where the drive moves both ways. dT_c alone is a constant load
//! T_0 = -dT_c to the last bit, at rest too: beside `constant_load` only dB_m is identifiable.

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Friction that is dT_c + dB_m |omega| less forward and as much more backward.
pub struct AsymmetricFriction;

impl Effect<2, 0> for AsymmetricFriction {
    const INFO: Info = Info {
        dry: true,
        fails_over: &[Variable::OmegaSign, Variable::Omega],
        aliases: &["constant_load"],
        nulls: &[("dT_c", 0.0), ("dB_m", 0.0)],
        ..Info::new(
            "asymmetric_friction",
            "torque = dT_c + dB_m * abs(omega); forward T_c - dT_c and F_v+ = B_m - dB_m, backward \
             T_c + dT_c and F_v- = B_m + dB_m",
            "sign of omega, and omega with another slope in each direction",
        )
    };
    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "dT_c",
            unit: "N m",
            nominal: 0.002,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            description: "half of Coulomb friction backward less forward",
        },
        Parameter {
            name: "dB_m",
            unit: "N m s/rad",
            nominal: 1e-5,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            description: "half of viscous friction backward less forward: (F_v- less F_v+) / 2",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([dt_c, db_m]: [R; 2], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        sum.forward -= dt_c;
        sum.backward += dt_c;
        sum.torque -= db_m * at.direction * at.omega;
    }

    fn affine_beyond(_: [f64; 2]) -> f64 {
        0.0
    }

    fn fastest([_, db_m]: [f64; 2], _: f64, inertia: f64) -> f64 {
        db_m.abs() / inertia
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn what_is_less_forward_is_more_backward() {
        let p = parameters::<AsymmetricFriction, 2, 0>([("dB_m", 1e-5), ("dT_c", 0.002)]);
        for direction in [1.0, -1.0] {
            let at = View { omega: 7.0 * direction, direction, ..AT };
            let sum = shared::<AsymmetricFriction, 2, 0>(p, [], at);
            assert_eq!((sum.forward, sum.backward), (-0.002, 0.002));
            // Against positive motion: backward it is a torque that pulls forward.
            assert_same(sum.torque, -1e-5 * 7.0);
        }
    }

    /// EMPS: a mean of 200 N s/m and a difference of 70 between backward and forward.
    #[test]
    fn the_viscous_friction_of_each_direction_follows() {
        let (b_m, p) = (200.0, [0.0, 35.0]);
        let viscous = |direction: f64| {
            let at = View { omega: 0.1 * direction, direction, ..AT };
            let asymmetric = shared::<AsymmetricFriction, 2, 0>(p, [], at).torque;
            (b_m * at.omega + asymmetric) / at.omega
        };
        assert_same(viscous(1.0), 165.0);
        assert_same(viscous(-1.0), 235.0);
    }
}
