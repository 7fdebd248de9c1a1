//! Torque ripple: the flux linkage of the armature, and with it K_m and K_e, depends on the
//! rotor's position (commutation, slots): N periods a revolution, in both balances.
//!
//! On a linear axis N is a wave number in rad/m: 2 pi over the spatial period.

use drivescope_numerics::Real;

use super::grid::{never_repeats, periods};
use super::law::{ActsOn, Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Flux 1 + a cos(N theta) + b sin(N theta) of the nominal flux.
pub struct TorqueRipple;

impl Effect<3, 0> for TorqueRipple {
    const INFO: Info = Info {
        fails_over: &[Variable::Theta, Variable::Current],
        acts_on: &[ActsOn::Torque, ActsOn::Voltage],
        aliases: &["cogging"],
        nulls: &[("a", 0.0), ("b", 0.0)],
        counts: &["N"],
        grid: |spans| periods("N", 1, spans),
        unseen: never_repeats,
        ..Info::new(
            "torque_ripple",
            "K_m, K_e times 1 + a cos(N theta) + b sin(N theta)",
            "theta, N periods: in the torque in proportion to i, in the back-EMF to omega",
        )
    };
    const PARAMETERS: [Parameter; 3] = [
        Parameter {
            name: "N",
            unit: "1",
            nominal: 12.0,
            range: (0.0, f64::INFINITY),
            description: "periods a revolution (linear: 2 pi over the spatial period, rad/m)",
        },
        Parameter {
            name: "a",
            unit: "1",
            nominal: 0.02,
            range: (-1.0, 1.0),
            description: "cosine share",
        },
        Parameter {
            name: "b",
            unit: "1",
            nominal: 0.02,
            range: (-1.0, 1.0),
            description: "sine share",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([n, a, b]: [R; 3], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        let (sin, cos) = (n * at.theta).sin_cos();
        sum.flux += a * cos + b * sin;
    }

    fn fastest([n, ..]: [f64; 3], speed: f64, inertia: f64) -> f64 {
        // The stiffness N |a, b| K_m i is that of the base drive's own rates times a small share.
        super::cogging::rate(n, 0.0, speed, inertia)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_flux_repeats_n_times_a_revolution() {
        let p = parameters::<TorqueRipple, 3, 0>([("a", 0.02), ("b", 0.03), ("N", 12.0)]);
        let flux = |theta: f64| shared::<TorqueRipple, 3, 0>(p, [], View { theta, ..AT }).flux;
        assert_eq!(flux(0.0), 1.02);
        let quarter = std::f64::consts::FRAC_PI_2 / 12.0;
        assert_same(flux(quarter), 1.03);
        assert_same(flux(2.0 * quarter), 0.98);
    }
}
