//! What the tests of several steps share.

/// Deterministic jitter within one half, without a pattern that a grid could follow.
pub(super) fn jitter(k: usize) -> f64 {
    (k as u64)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .rotate_left(29)
        .wrapping_mul(0xbf58_476d_1ce4_e5b9) as f64
        / u64::MAX as f64
        - 0.5
}
