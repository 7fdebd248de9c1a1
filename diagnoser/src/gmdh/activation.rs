//! Activation functions xi of GMDH neurons; invertible, as (18) asks.

use drivescope_numerics::elementary::tanh;
use serde::{Deserialize, Serialize};

/// xi, strictly increasing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Activation {
    /// xi(q) = q.
    Identity,
    /// xi(q) = tanh q.
    Tanh,
}

impl Activation {
    /// xi(q).
    #[inline]
    pub fn value(self, q: f64) -> f64 {
        match self {
            Self::Identity => q,
            Self::Tanh => tanh(q),
        }
    }

    /// xi^-1(s); infinite where no q reaches s: such a bound of (18) holds for every parameter.
    #[inline]
    pub fn inverse(self, s: f64) -> f64 {
        match self {
            Self::Identity => s,
            Self::Tanh if s >= 1.0 => f64::INFINITY,
            Self::Tanh if s <= -1.0 => f64::NEG_INFINITY,
            Self::Tanh => s.atanh(),
        }
    }

    /// d xi / dq where xi(q) = `s`.
    #[inline]
    pub(super) fn slope(self, s: f64) -> f64 {
        match self {
            Self::Identity => 1.0,
            Self::Tanh => 1.0 - s * s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_inverts_and_the_slope_is_the_derivative() {
        for activation in [Activation::Identity, Activation::Tanh] {
            for q in [-2.0, -0.3, 0.0, 0.7, 1.9] {
                let s = activation.value(q);
                assert!((activation.inverse(s) - q).abs() < 1e-13);
                let h = 1e-6;
                let difference = (activation.value(q + h) - activation.value(q - h)) / (2.0 * h);
                assert!((activation.slope(s) - difference).abs() < 1e-9);
            }
        }
        assert_eq!(Activation::Tanh.inverse(1.0), f64::INFINITY);
        assert_eq!(Activation::Tanh.inverse(-1.2), f64::NEG_INFINITY);
    }
}
