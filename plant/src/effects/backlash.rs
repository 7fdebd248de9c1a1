//! Backlash: motor and load are two masses with play between them; inside the gap nothing is
//! transmitted, at its ends spring and damper are.
//!
//! J_l = ratio J,  J_m = (1 - ratio) J,  dphi/dt = omega - omega_l,
//! T_k = k delta(phi) + d delta'(phi) dphi/dt,
//! J_m domega/dt = ... - T_k,  J_l domega_l/dt = T_k - T_l.
//! delta is phi beyond half the gap, with sharp corners: rounded ones bend the response by more
//! than what most sensors show. The damper alone, whose torque would jump where the teeth meet,
//! comes in over s = gap / 100, so that derivatives hold through a knock:
//! delta' = 1 + ((phi - gap/2) / sqrt((phi - gap/2)^2 + s^2)
//!               - (phi + gap/2) / sqrt((phi + gap/2)^2 + s^2)) / 2.

use drivescope_numerics::Real;

use super::grid::{Shape, Spans};
use super::law::{Beside, Effect, Info, OwnState, Parameter, Sum, Variable, View};
use super::two_masses::{self, BEHIND, joint};

/// Gaps at which it is weighed, rad; on an axis, over what compares with it.
const GAPS: [f64; 4] = [0.03, 0.1, 0.2, 0.35];
/// Natural frequency of the contact, Hz, and its damping ratio.
const HZ: f64 = 60.0;
const DAMPING: f64 = 0.2;

fn grid(spans: &Spans) -> Vec<Shape> {
    let of = |ratio: f64, gap: f64| {
        let (k, d) = joint(spans.inertia, ratio, HZ.min(spans.nyquist_hz()), DAMPING);
        vec![("k", k), ("d", d), ("gap", gap * spans.radian()), ("ratio", ratio)]
    };
    BEHIND.into_iter().flat_map(|ratio| GAPS.map(|gap| of(ratio, gap))).collect()
}

/// Way over which the damper comes in, over the gap.
const ONSET: f64 = 0.01;
/// Least square of that way, rad^2: it keeps the root's slope finite where there is no gap.
const LEAST_SQUARE: f64 = 1e-24;

/// Rate of a knock over that of the masses on the closed contact: its kink costs as much accuracy.
const KNOCK: f64 = 1.5;

/// Two masses with play: the twist `phi`, and the slip between them.
pub struct Backlash;

impl Backlash {
    /// Torque through the teeth.
    #[inline(always)]
    fn torque<R: Real>([k, d, gap, _]: [R; 4], [phi, slip]: [R; 2]) -> R {
        let half = gap.scaled(0.5);
        let onset = gap.scaled(ONSET);
        let square = onset * onset + R::constant(LEAST_SQUARE);
        let (over, under) = (phi - half, phi + half);
        let depth = if over.value() > 0.0 {
            over
        } else if under.value() < 0.0 {
            under
        } else {
            R::zero()
        };
        let upper = (over * over + square).sqrt();
        let lower = (under * under + square).sqrt();
        let touch = R::one() + (over / upper - under / lower).scaled(0.5);
        k * depth + d * touch * slip
    }
}

/// Own states: the twist phi, zero in the middle of the gap, and the slip omega - omega_l.
impl Effect<4, 2> for Backlash {
    const INFO: Info = Info {
        fails_over: &[Variable::Acceleration, Variable::OmegaSign],
        excludes: &["backlash", "flexible_coupling"],
        nulls: &[("k", f64::INFINITY), ("gap", 0.0)],
        grid,
        kinked: true,
        knocks: true,
        ..Info::new(
            "backlash",
            "J splits into (1 - ratio) J and ratio J with play: T_k = k delta + d ddelta/dt, delta \
             = phi beyond half the gap",
            "reversals of the torque: the motor runs alone, then a knock",
        )
    };
    const PARAMETERS: [Parameter; 4] = [
        Parameter {
            name: "k",
            unit: "N m/rad",
            nominal: 5.0,
            range: (f64::MIN_POSITIVE, f64::INFINITY),
            description: "stiffness of the contact",
        },
        Parameter {
            name: "d",
            unit: "N m s/rad",
            nominal: 5e-3,
            range: (0.0, f64::INFINITY),
            description: "damping of the contact",
        },
        Parameter {
            name: "gap",
            unit: "rad",
            nominal: 0.02,
            range: (0.0, f64::INFINITY),
            description: "play from one side to the other",
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
            description: "twist against the middle of the gap",
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
    fn share<R: Real>(p: [R; 4], x: [R; 2], at: &View<R>, sum: &mut Sum<R>) {
        two_masses::share(Self::torque(p, x), p[3], at, sum);
    }

    #[inline(always)]
    fn rate<R: Real>(p: [R; 4], x: [R; 2], at: &View<R>, sum: &Sum<R>) -> [R; 2] {
        two_masses::rate(Self::torque(p, x), p[3], x[1], at, sum)
    }

    fn fastest([k, d, _, ratio]: [f64; 4], _: f64, inertia: f64) -> f64 {
        KNOCK * two_masses::fastest([k, d, ratio], inertia)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::flexible_coupling::FlexibleCoupling;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    fn values() -> [f64; 4] {
        parameters::<Backlash, 4, 2>([("ratio", 0.25), ("gap", 0.02), ("d", 1e-3), ("k", 5.0)])
    }

    /// What the onset of the damper leaves of the law with a sudden one, half a gap from it.
    const ONSET_LEFT: f64 = 2e-4;

    #[test]
    fn nothing_is_transmitted_in_the_gap_and_a_spring_beyond_it() {
        let load = |x| shared::<Backlash, 4, 2>(values(), x, AT).load;
        assert_eq!(load([0.0, 0.0]), 0.0);
        let full = 5.0 * 0.03 + 1e-3 * 2.0;
        for side in [1.0, -1.0] {
            assert!((load([0.04 * side, 2.0 * side]) / full * side - 1.0).abs() < ONSET_LEFT);
            assert!(load([0.004 * side, 2.0 * side]).abs() < ONSET_LEFT * full);
        }
        assert_same(
            shared::<Backlash, 4, 2>(values(), [0.0; 2], AT).inverse_inertia * AT.inertia,
            1.0 / 0.75,
        );
    }

    #[test]
    fn the_spring_begins_sharply_where_the_teeth_meet() {
        let load = |phi| shared::<Backlash, 4, 2>(values(), [phi, 0.0], AT).load;
        for side in [1.0, -1.0] {
            assert_eq!(load(0.01 * side), 0.0);
            assert!((load(0.010_01 * side) - 5.0 * 1e-5 * side).abs() < 1e-15);
        }
    }

    #[test]
    fn without_a_gap_it_is_the_flexible_coupling() {
        let [k, d, _, ratio] = values();
        let x = [0.01, 2.0];
        let closed = shared::<Backlash, 4, 2>([k, d, 0.0, ratio], x, AT);
        let coupled = shared::<FlexibleCoupling, 3, 2>([k, d, ratio], x, AT);
        assert_eq!(closed, coupled);
        let rates = Backlash::rate([k, d, 0.0, ratio], x, &AT, &closed);
        assert_eq!(rates, FlexibleCoupling::rate([k, d, ratio], x, &AT, &coupled));
    }
}
