//! Forward-mode derivatives: a number and its derivatives by `P` parameters.

use std::array::from_fn;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::{Real, elementary};

/// A value and its derivatives by `P` parameters; exact, by the rules of differentiation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const P: usize> {
    /// The value.
    pub v: f64,
    /// Its derivative by each parameter.
    pub d: [f64; P],
}

impl<const P: usize> Dual<P> {
    /// The parameter number `k` at that value: derivative 1 by itself, 0 by the others.
    #[inline(always)]
    pub fn parameter(value: f64, k: usize) -> Self {
        Self { v: value, d: from_fn(|j| if j == k { 1.0 } else { 0.0 }) }
    }

    /// f(self), from its value and its derivative at `self.v`.
    #[inline(always)]
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { v: value, d: self.d.map(|d| derivative * d) }
    }
}

impl<const P: usize> Add for Dual<P> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { v: self.v + o.v, d: from_fn(|k| self.d[k] + o.d[k]) }
    }
}

impl<const P: usize> Sub for Dual<P> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { v: self.v - o.v, d: from_fn(|k| self.d[k] - o.d[k]) }
    }
}

impl<const P: usize> Mul for Dual<P> {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the product rule")]
    fn mul(self, o: Self) -> Self {
        Self { v: self.v * o.v, d: from_fn(|k| self.d[k] * o.v + self.v * o.d[k]) }
    }
}

impl<const P: usize> Div for Dual<P> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let v = self.v / o.v;
        let inverse = 1.0 / o.v;
        Self { v, d: from_fn(|k| (self.d[k] - v * o.d[k]) * inverse) }
    }
}

impl<const P: usize> Neg for Dual<P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { v: -self.v, d: self.d.map(|d| -d) }
    }
}

impl<const P: usize> AddAssign for Dual<P> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<const P: usize> SubAssign for Dual<P> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl<const P: usize> MulAssign for Dual<P> {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl<const P: usize> Real for Dual<P> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { v: value, d: [0.0; P] }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.v
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.v.is_finite() && self.d.iter().all(|d| d.is_finite())
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let e = elementary::exp(self.v);
        self.chain(e, e)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = elementary::sin_cos(self.v);
        (self.chain(s, c), self.chain(c, -s))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.v.sqrt();
        self.chain(root, 0.5 / root)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.v.ln(), 1.0 / self.v)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        let t = elementary::tanh(self.v);
        self.chain(t, 1.0 - t * t)
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        self.chain(self.v * factor, factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central differences with a step of 1e-6 are exact to about 1e-9 on functions of size 1.
    const DIFFERENCE: f64 = 1e-8;

    fn curve<R: Real>(x: R, a: R) -> R {
        let (s, c) = (a * x).sin_cos();
        (x * a).exp() * s / (R::one() + c * c) + (x * x + a).sqrt().ln() - (a - x).abs().tanh()
    }

    #[test]
    fn derivatives_agree_with_finite_differences() {
        let (x, a, h) = (0.7, 1.3, 1e-6);
        let dual = curve(Dual::<2>::parameter(x, 0), Dual::parameter(a, 1));
        let by_x = (curve(x + h, a) - curve(x - h, a)) / (2.0 * h);
        let by_a = (curve(x, a + h) - curve(x, a - h)) / (2.0 * h);
        assert_eq!(dual.v, curve(x, a));
        assert!((dual.d[0] - by_x).abs() < DIFFERENCE, "{} against {by_x}", dual.d[0]);
        assert!((dual.d[1] - by_a).abs() < DIFFERENCE, "{} against {by_a}", dual.d[1]);
    }

    #[test]
    fn division_and_selection_carry_their_derivatives() {
        let x = Dual::<1>::parameter(-2.0, 0);
        let y = Dual::one() / (x * x);
        assert!((y.d[0] - 0.25).abs() < 1e-15);
        assert_eq!(x.abs().d[0], -1.0);
        assert_eq!(x.scaled(3.0).d[0], 3.0);
    }
}
