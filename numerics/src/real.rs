//! The scalar over which the physics is written once.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::elementary;

/// A real number as a model needs it: `f64` for a run, [`crate::Dual`] for its derivatives.
///
/// Comparisons go through [`Real::value`] and choices through [`Real::select`], so that the
/// generic code has no branches and lanes of it vectorise.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// A number that does not depend on any parameter.
    fn constant(value: f64) -> Self;

    /// The number itself, without derivatives.
    fn value(self) -> f64;

    /// Whether the number and every derivative are finite.
    fn is_finite(self) -> bool;

    /// `chosen` if the condition holds, else `other`; both are evaluated.
    #[inline(always)]
    fn select(condition: bool, chosen: Self, other: Self) -> Self {
        if condition { chosen } else { other }
    }

    /// e^x.
    fn exp(self) -> Self;

    /// Sine and cosine of an angle in rad.
    fn sin_cos(self) -> (Self, Self);

    /// Square root.
    fn sqrt(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// Hyperbolic tangent.
    fn tanh(self) -> Self;

    /// Magnitude; at zero the derivative is that of `x`.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.value() < 0.0, -self, self)
    }

    /// Sine of an angle in rad.
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Cosine of an angle in rad.
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::constant(0.0)
    }

    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::constant(1.0)
    }

    /// The number times a plain factor.
    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        elementary::sin_cos(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        f64::ln(self)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        elementary::tanh(self)
    }
}
