//! Presliding: bristles bend before the contact slides (Dahl, 1968; with a level that falls
//! with speed, LuGre without micro-damping, Canudas de Wit et al., 1995).
//!
//! T = sigma_0 z,  dz/dt = omega - sigma_0 |omega| z / g(omega),
//! g the total level of dry friction in the direction of motion. It takes the place of the
//! jump at rest: z cannot exceed g / sigma_0.

use drivescope_numerics::Real;

use super::grid::each;
use super::law::{Effect, Info, OwnState, Parameter, Sum, Variable, View};

/// Below this level (N m) there is no contact to bend; it keeps the quotient finite.
const LEAST_LEVEL: f64 = 1e-12;

/// A torque of k times the level turns the bristles over in sqrt(2 / k) of the time in which they
/// swing freely; motors pull an order of magnitude harder than their friction.
const REVERSAL: f64 = 3.0;

/// Deflections at which bristles slip that are tried, rad; on an axis, over what compares with it.
const SLIPS: [f64; 4] = [0.003, 0.03, 0.1, 0.3];

/// Dry friction through a bristle deflection, one stiff own state.
pub struct Presliding;

impl Presliding {
    /// The rate at which the deflection forgets: sigma_0 |omega| / g, 1/s.
    #[inline(always)]
    fn forgetting<R: Real>(sigma_0: R, at: &View<R>, sum: &Sum<R>) -> R {
        let level = R::select(at.direction.value() >= 0.0, sum.forward, sum.backward);
        let least = R::constant(LEAST_LEVEL);
        let level = R::select(level.value() > LEAST_LEVEL, level, least);
        sigma_0 * at.direction * at.omega / level
    }
}

impl Effect<1, 1> for Presliding {
    const INFO: Info = Info {
        replaces_dry: true,
        stiff: true,
        fails_over: &[Variable::Omega, Variable::OmegaSign, Variable::Acceleration],
        excludes: &["presliding"],
        nulls: &[("sigma_0", f64::INFINITY)],
        grid: |spans| each("sigma_0", SLIPS.map(|share| spans.dry / (share * spans.radian()))),
        ..Info::new(
            "presliding",
            "friction of sigma_0 z instead of dry friction; dz/dt = omega - sigma_0 |omega| z / g(omega)",
            "reversals",
        )
    };
    const PARAMETERS: [Parameter; 1] = [Parameter {
        name: "sigma_0",
        unit: "N m/rad",
        nominal: 10.0,
        range: (f64::MIN_POSITIVE, f64::INFINITY),
        description: "stiffness of the bristles",
    }];
    const STATES: [OwnState; 1] = [OwnState {
        name: "z",
        unit: "rad",
        nominal: 0.001,
        description: "deflection of the bristles",
        beside: None,
    }];

    #[inline(always)]
    fn share<R: Real>([sigma_0]: [R; 1], [z]: [R; 1], _: &View<R>, sum: &mut Sum<R>) {
        sum.torque += sigma_0 * z;
    }

    #[inline(always)]
    fn rate<R: Real>([sigma_0]: [R; 1], [z]: [R; 1], at: &View<R>, sum: &Sum<R>) -> [R; 1] {
        [at.omega - Self::forgetting(sigma_0, at, sum) * z]
    }

    #[inline(always)]
    fn decay<R: Real>([sigma_0]: [R; 1], _: [R; 1], at: &View<R>, sum: &Sum<R>) -> [R; 1] {
        [Self::forgetting(sigma_0, at, sum)]
    }

    fn fastest([sigma_0]: [f64; 1], _: f64, inertia: f64) -> f64 {
        REVERSAL * (sigma_0 / inertia).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::by_name::{AT, assert_same, parameters, shared};

    #[test]
    fn the_bristles_bend_until_they_carry_the_dry_friction() {
        let p = parameters::<Presliding, 1, 1>([("sigma_0", 10.0)]);
        let sum = Sum { forward: 0.02, ..shared::<Presliding, 1, 1>(p, [0.001], AT) };
        assert_same(sum.torque, 0.01);
        let rate = |z: f64| Presliding::rate(p, [z], &AT, &sum)[0];
        assert_same(rate(0.0), AT.omega);
        assert!(rate(0.002).abs() < 1e-14, "sliding at sigma_0 z = g");
        assert_same(Presliding::decay(p, [0.0], &AT, &sum)[0], 10.0 * AT.omega / 0.02);
    }

    #[test]
    fn a_cycle_takes_energy_and_its_start_gives_it_back() {
        let p = parameters::<Presliding, 1, 1>([("sigma_0", 10.0)]);
        let level =
            Sum { forward: 0.02, backward: 0.02, ..shared::<Presliding, 1, 1>(p, [0.0], AT) };
        // theta = amplitude sin t over a cycle after the first: work of the torque.
        let work = |amplitude: f64| {
            let (n, mut z, mut work) = (40_000, 0.0, 0.0);
            let h = std::f64::consts::TAU / f64::from(n);
            for k in 0..2 * n {
                let omega = amplitude * (f64::from(k) * h).cos();
                let at = View { omega, direction: omega.signum(), ..AT };
                z += h * Presliding::rate(p, [z], &at, &level)[0];
                let torque = shared::<Presliding, 1, 1>(p, [z], at).torque;
                work += if k >= n { h * torque * omega } else { 0.0 };
            }
            work
        };
        // Far beyond the presliding zone: 4 amplitudes at the full level. Within it: a spring.
        let slid = work(2.0) / (4.0 * 2.0 * 0.02);
        assert!((0.99..1.0).contains(&slid), "{slid}");
        let bent = work(2e-5) / (4.0 * 2e-5 * 0.02);
        assert!((0.0..0.01).contains(&bent), "{bent}");
    }
}
