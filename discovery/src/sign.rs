//! The direction of a value.

/// 1 or -1, and 0 where there is no direction.
pub(crate) fn sign(z: f64) -> f64 {
    if z == 0.0 { 0.0 } else { z.signum() }
}
