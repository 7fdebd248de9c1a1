//! Stribeck friction: T_b exp(-(omega/omega_s)^2) sgn(omega) on top of Coulomb friction,
//! so that the break-away torque is T_s = T_c + T_b (Armstrong-Helouvry, 1991).

use drivescope_numerics::Real;

use super::grid::{SLOW_SPEED, Spans, each};
use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Beyond this many omega_s the exponential is below 1e-16 of T_b: less than its rounding error.
const AFFINE_BEYOND: f64 = 6.1;

/// Stribeck speeds at which it is weighed, over the fastest speed.
const SPEEDS: [f64; 4] = [0.005, 0.015, 0.04, 0.1];
/// Share of the time in slow motion from which on that was recorded: a shaft that is only ever
/// accelerated spends a tenth there, one that is cruising and reversed quickly less.
const SLOW_ENOUGH: f64 = 0.06;

/// It shows in slow motion only.
fn nothing_slow(spans: &Spans) -> Option<String> {
    let (share, limit) = (100.0 * spans.slow, SLOW_SPEED * spans.speed);
    let unit = if spans.rotary { "rad/s" } else { "m/s" };
    (spans.slow < SLOW_ENOUGH).then(|| {
        format!(
            "shows in slow motion only, and nothing slow enough was recorded: {share:.0} % of the \
             time is below {limit:.3} {unit}, a tenth of the fastest speed, and that in passing; \
             record slow reversals"
        )
    })
}

/// Dry friction that falls with speed near rest.
pub struct Stribeck;

impl Effect<2, 0> for Stribeck {
    const INFO: Info = Info {
        dissipates: true,
        fails_over: &[Variable::Omega, Variable::OmegaSign],
        dry: true,
        nulls: &[("T_b", 0.0)],
        grid: |spans| each("omega_s", SPEEDS.map(|share| share * spans.speed)),
        unseen: nothing_slow,
        ..Info::new(
            "stribeck",
            "torque = -T_b * exp(-(omega / omega_s)^2) * sign(omega); T_s = T_c + T_b",
            "omega near zero",
        )
    };
    const PARAMETERS: [Parameter; 2] = [
        Parameter {
            name: "T_b",
            unit: "N m",
            nominal: 0.005,
            range: (0.0, f64::INFINITY),
            description: "break-away torque above Coulomb friction",
        },
        Parameter {
            name: "omega_s",
            unit: "rad/s",
            nominal: 5.0,
            range: (f64::MIN_POSITIVE, f64::INFINITY),
            description: "Stribeck speed",
        },
    ];
    const STATES: [OwnState; 0] = [];

    #[inline(always)]
    fn share<R: Real>([t_b, omega_s]: [R; 2], _: [R; 0], at: &View<R>, sum: &mut Sum<R>) {
        let ratio = at.omega / omega_s;
        let level = t_b * (-(ratio * ratio)).exp();
        sum.forward += level;
        sum.backward += level;
    }

    fn affine_beyond([_, omega_s]: [f64; 2]) -> f64 {
        AFFINE_BEYOND * omega_s
    }

    fn grain([_, omega_s]: [f64; 2]) -> f64 {
        omega_s
    }

    fn fastest([t_b, omega_s]: [f64; 2], _: f64, inertia: f64) -> f64 {
        // Greatest slope of the curve, sqrt(2/e) T_b / omega_s, over the inertia.
        0.86 * t_b / omega_s / inertia
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn it_adds_to_break_away_and_is_gone_at_speed() {
        let p = parameters::<Stribeck, 2, 0>([("omega_s", 5.0), ("T_b", 0.008)]);
        let level = |omega: f64| shared::<Stribeck, 2, 0>(p, [], View { omega, ..AT }).forward;
        assert_eq!(level(0.0), 0.008);
        assert_same(level(5.0), 0.008 / std::f64::consts::E);
        assert_eq!(level(-5.0), level(5.0));
        // Beyond the affine speed it is less than a rounding error of itself at rest.
        assert!(level(Stribeck::affine_beyond(p)) < 0.008 * f64::EPSILON);
    }
}
