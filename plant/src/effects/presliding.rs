//! Presliding: bristles bend before the contact slides (Dahl, 1968; with a level that falls
//! with speed, LuGre without micro-damping, Canudas de Wit et al., 1995).
//!
//! T = sigma_0 z,  dz/dt = omega - sigma_0 |omega| z / g(omega),
//! g the total level of dry friction in the direction of motion. It takes the place of the
//! jump at rest: z cannot exceed g / sigma_0.

use drivescope_numerics::Real;

use super::law::{Effect, Info, OwnState, Parameter, Sum, View};

/// Below this level (N m) there is no contact to bend; it keeps the quotient finite.
const LEAST_LEVEL: f64 = 1e-12;

/// Dry friction through a bristle deflection, one stiff own state.
pub struct Presliding;

impl Presliding {
    /// The rate at which the deflection forgets: sigma_0 |omega| / g, 1/s.
    #[inline(always)]
    fn forgetting<R: Real>(sigma_0: R, at: &View<R>, sum: &Sum<R>) -> R {
        let level = R::select(at.omega.value() >= 0.0, sum.forward, sum.backward);
        let least = R::constant(LEAST_LEVEL);
        let level = R::select(level.value() > LEAST_LEVEL, level, least);
        sigma_0 * at.omega.abs() / level
    }
}

impl Effect<1, 1> for Presliding {
    const INFO: Info = Info {
        replaces_dry: true,
        stiff: true,
        nulls: &[("sigma_0", f64::INFINITY)],
        ..Info::new(
            "presliding",
            "torque = sigma_0 z instead of dry friction; dz/dt = omega - sigma_0 |omega| z / g(omega)",
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
        (sigma_0 / inertia).sqrt()
    }
}
