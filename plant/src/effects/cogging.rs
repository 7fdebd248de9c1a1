//! Cogging: a torque that depends on the rotor's position, N periods a revolution
//! (on a linear axis N is a wave number in rad/m: 2 pi over the spatial period).

use drivescope_numerics::Real;

use super::grid::{never_repeats, periods};
use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Share of N omega that counts as a rate: the ripple is imposed on the motion, a quadrature off
/// by x^4 / 2880 of it, where a free oscillation would be off by x^4 / 120 a radian.
const IMPOSED: f64 = 0.1;

/// Rate that a ripple of `n` periods a revolution and that amplitude (N m) brings in, 1/s: its
/// passing at that speed, or the oscillation about a position where it holds the rotor.
pub(super) fn rate(n: f64, amplitude: f64, speed: f64, inertia: f64) -> f64 {
    (IMPOSED * n * speed).abs().max((n * amplitude / inertia).sqrt())
}

/// Torque a cos(N theta) + b sin(N theta).
pub struct Cogging;

impl Effect<3, 0> for Cogging {
    const INFO: Info = Info {
        fails_over: &[Variable::Theta],
        aliases: &["torque_ripple", "unbalance"],
        nulls: &[("a", 0.0), ("b", 0.0)],
        counts: &["N"],
        // Once a revolution it is an unbalance.
        grid: |spans| periods("N", 2, spans),
        unseen: never_repeats,
        ..Info::new(
            "cogging",
            "torque = -(a * cos(N * theta) + b * sin(N * theta))",
            "theta, N periods",
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
            unit: "N m",
            nominal: 0.002,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            description: "cosine amplitude",
        },
        Parameter {
            name: "b",
            unit: "N m",
            nominal: 0.002,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            description: "sine amplitude",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([n, a, b]: [R; 3], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        let (sin, cos) = (n * at.theta).sin_cos();
        sum.torque += a * cos + b * sin;
    }

    fn fastest([n, a, b]: [f64; 3], speed: f64, inertia: f64) -> f64 {
        rate(n, a.hypot(b), speed, inertia)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_torque_repeats_n_times_a_revolution() {
        let p = parameters::<Cogging, 3, 0>([("a", 0.002), ("b", 0.003), ("N", 12.0)]);
        let torque = |theta: f64| shared::<Cogging, 3, 0>(p, [], View { theta, ..AT }).torque;
        assert_eq!(torque(0.0), 0.002);
        let quarter = std::f64::consts::FRAC_PI_2 / 12.0;
        assert_same(torque(quarter), 0.003);
        assert_same(torque(2.0 * quarter), -0.002);
    }
}
