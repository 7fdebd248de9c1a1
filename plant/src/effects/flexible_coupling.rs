//! Flexible coupling: the inertia splits into motor and load, joined by a spring and a damper.
//!
//! J_l = ratio J,  J_m = (1 - ratio) J,  T_k = k phi + d (omega - omega_l),
//! J_m domega/dt = ... - T_k,  J_l domega_l/dt = T_k - T_l,  dphi/dt = omega - omega_l.

use drivescope_numerics::Real;

use super::grid::{Shape, Spans};
use super::law::{Beside, Effect, Info, OwnState, Parameter, Sum, Variable, View};
use super::two_masses::{self, BEHIND, joint};

/// Natural frequencies of a coupling at which it is weighed, Hz, and its damping ratio.
const HZ: [f64; 6] = [8.0, 13.0, 20.0, 30.0, 50.0, 90.0];
const DAMPING: f64 = 0.05;

fn grid(spans: &Spans) -> Vec<Shape> {
    let of = |ratio: f64, hz: f64| {
        let (k, d) = joint(spans.inertia, ratio, hz, DAMPING);
        vec![("k", k), ("d", d), ("ratio", ratio)]
    };
    let seen = |hz: &f64| *hz == HZ[0] || *hz < spans.nyquist_hz();
    let seen: Vec<f64> = HZ.into_iter().filter(seen).collect();
    BEHIND.into_iter().flat_map(|ratio| seen.iter().map(move |hz| of(ratio, *hz))).collect()
}

/// Two masses: the load's speed lags by `omega - lag`, and the twist `phi`.
pub struct FlexibleCoupling;

impl FlexibleCoupling {
    #[inline(always)]
    fn torque<R: Real>([k, d, _]: [R; 3], [phi, slip]: [R; 2]) -> R {
        k * phi + d * slip
    }
}

/// Own states: the twist phi and the slip omega - omega_l. Both are zero in a drive at rest
/// or in steady motion without load, whatever its speed.
impl Effect<3, 2> for FlexibleCoupling {
    const INFO: Info = Info {
        fails_over: &[Variable::Acceleration],
        excludes: &["flexible_coupling", "backlash"],
        nulls: &[("k", f64::INFINITY)],
        grid,
        ..Info::new(
            "flexible_coupling",
            "J splits into (1 - ratio) J and ratio J, joined by T_k = k phi + d dphi/dt",
            "acceleration, ringing after steps",
        )
    };
    const PARAMETERS: [Parameter; 3] = [
        Parameter {
            name: "k",
            unit: "N m/rad",
            nominal: 5.0,
            range: (f64::MIN_POSITIVE, f64::INFINITY),
            description: "stiffness of the coupling",
        },
        Parameter {
            name: "d",
            unit: "N m s/rad",
            nominal: 1e-3,
            range: (0.0, f64::INFINITY),
            description: "damping of the coupling",
        },
        Parameter {
            name: "ratio",
            unit: "1",
            nominal: 0.5,
            range: (0.01, 0.99),
            description: "share of J on the load's side",
        },
    ];
    const STATES: [OwnState; 2] = [
        OwnState {
            name: "phi",
            unit: "rad",
            nominal: 0.01,
            description: "twist of the coupling",
            beside: Some(Beside::LoadPosition),
        },
        OwnState {
            name: "slip",
            unit: "rad/s",
            nominal: 1.0,
            description: "speed of the motor less that of the load",
            beside: Some(Beside::LoadSpeed),
        },
    ];

    #[inline(always)]
    fn share<R: Real>(p: [R; 3], x: [R; 2], at: &View<R>, sum: &mut Sum<R>) {
        two_masses::share(Self::torque(p, x), p[2], at, sum);
    }

    #[inline(always)]
    fn rate<R: Real>(p: [R; 3], x: [R; 2], at: &View<R>, sum: &Sum<R>) -> [R; 2] {
        two_masses::rate(Self::torque(p, x), p[2], x[1], at, sum)
    }

    fn fastest([k, d, ratio]: [f64; 3], _: f64, inertia: f64) -> f64 {
        two_masses::fastest([k, d, ratio], inertia)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::grid::SPANS;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_load_hangs_on_spring_and_damper() {
        let p = parameters::<FlexibleCoupling, 3, 2>([("ratio", 0.25), ("d", 1e-3), ("k", 5.0)]);
        let x = [0.01, 2.0];
        let sum = shared::<FlexibleCoupling, 3, 2>(p, x, AT);
        assert_same(sum.load, 5.0 * 0.01 + 1e-3 * 2.0);
        assert_same(sum.inverse_inertia, 1.0 / (0.75 * AT.inertia));
        let [twist, slip] = FlexibleCoupling::rate(p, x, &AT, &sum);
        assert_eq!(twist, 2.0);
        // A motor that does not accelerate: the slip falls as the load speeds up.
        assert_same(slip, -(0.052 - AT.load) / (0.25 * AT.inertia));
    }

    #[test]
    fn what_samples_cannot_show_is_not_weighed() {
        let shapes = |period_s: f64| grid(&Spans { period_s, ..SPANS }).len() / BEHIND.len();
        assert_eq!(shapes(1e-3), HZ.len());
        assert_eq!(shapes(0.02), 3, "8, 13 and 20 Hz lie below 25 Hz");
        assert_eq!(shapes(0.5), 1, "a grid is never empty");
    }
}
