//! Motor and load as two masses, whatever joins them:
//!
//! J_l = ratio J,  J_m = (1 - ratio) J,  dphi/dt = slip = omega - omega_l,
//! J_m domega/dt = ... - T_k,  J_l domega_l/dt = T_k - T_l.

use std::f64::consts::TAU;

use drivescope_numerics::Real;

use super::law::{Sum, View};

/// Shares of the inertia behind the joint at which it is weighed.
pub(super) const BEHIND: [f64; 2] = [0.25, 0.5];

/// Stiffness (N m/rad) and damping (N m s/rad) of a joint with that natural frequency and damping
/// ratio.
pub(super) fn joint(inertia: f64, ratio: f64, hz: f64, damping: f64) -> (f64, f64) {
    let reduced = inertia * ratio * (1.0 - ratio);
    let rate = TAU * hz;
    (reduced * rate * rate, 2.0 * damping * reduced * rate)
}

/// Leaves the motor its own share of the inertia, loaded by the torque T_k of the joint.
#[inline(always)]
pub(super) fn share<R: Real>(torque: R, ratio: R, at: &View<R>, sum: &mut Sum<R>) {
    sum.inverse_inertia = R::one() / (at.inertia * (R::one() - ratio));
    sum.load = torque;
}

/// Time derivatives of twist and slip.
#[inline(always)]
pub(super) fn rate<R: Real>(torque: R, ratio: R, slip: R, at: &View<R>, sum: &Sum<R>) -> [R; 2] {
    let load = (torque - at.load) / (at.inertia * ratio);
    [slip, sum.acceleration - load]
}

/// Rate of the masses on a joint of that stiffness and damping, 1/s.
pub(super) fn fastest([k, d, ratio]: [f64; 3], inertia: f64) -> f64 {
    let reduced = inertia * ratio * (1.0 - ratio);
    (k / reduced).sqrt().max(d / reduced)
}
