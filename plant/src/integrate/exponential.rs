//! Coefficients of the exponential Runge-Kutta step of order four (Cox and Matthews, 2002).
//!
//! A state with x' = N(x, ..) - lambda x takes its decay exactly; for lambda = 0 the step is
//! the classical Runge-Kutta step. So neither a short armature time constant nor a stiff
//! bristle sets the step size.

use drivescope_numerics::Real;

/// Coefficients for decay rates `lambda` and a step `h`, one lane each.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub(super) struct Exponential<R, const N: usize> {
    /// e^(-lambda h / 2).
    pub half: [R; N],
    /// e^(-lambda h).
    pub whole: [R; N],
    /// (h / 2) phi_1(-lambda h / 2).
    pub stage: [R; N],
    /// h (phi_1 - 3 phi_2 + 4 phi_3): weight of the first slope.
    pub first: [R; N],
    /// 2 h (phi_2 - 2 phi_3): weight of the two middle slopes.
    pub middle: [R; N],
    /// h (4 phi_3 - phi_2): weight of the last slope.
    pub last: [R; N],
}

/// Below this argument the phi functions are summed as series: their recurrences cancel.
const SERIES_BELOW: f64 = 0.7;

/// phi_1 = (e^z - 1) / z, phi_2 = (phi_1 - 1) / z, phi_3 = (phi_2 - 1/2) / z; and e^z.
#[inline(always)]
fn phi<R: Real>(z: R) -> (R, [R; 3]) {
    let e = z.exp();
    // phi_3 = sum z^k / (k + 3)!, by Horner; 0.7^16 / 18! is below 1e-18.
    let mut series = R::zero();
    let mut factorial = 6_402_373_705_728_000.0; // 18!
    for k in (0..16).rev() {
        series = series * z + R::constant(1.0 / factorial);
        factorial /= f64::from(k + 3);
    }
    let small = z.value().abs() < SERIES_BELOW;
    let divisor = R::select(small, R::one(), z);
    let phi_1 = (e - R::one()) / divisor;
    let phi_2 = (phi_1 - R::one()) / divisor;
    let phi_3 = (phi_2 - R::constant(0.5)) / divisor;
    let series_2 = series * z + R::constant(0.5);
    let series_1 = series_2 * z + R::one();
    let chosen = |by_series, direct| R::select(small, by_series, direct);
    (e, [chosen(series_1, phi_1), chosen(series_2, phi_2), chosen(series, phi_3)])
}

impl<R: Real, const N: usize> Exponential<R, N> {
    #[inline(always)]
    pub(super) fn new(lambda: &[R; N], h: R) -> Self {
        let zero = [R::zero(); N];
        let mut made =
            Self { half: zero, whole: zero, stage: zero, first: zero, middle: zero, last: zero };
        for l in 0..N {
            let z = -(lambda[l] * h);
            let (whole, [phi_1, phi_2, phi_3]) = phi(z);
            let (half, [half_phi_1, ..]) = phi(z.scaled(0.5));
            made.half[l] = half;
            made.whole[l] = whole;
            made.stage[l] = h.scaled(0.5) * half_phi_1;
            made.first[l] = h * (phi_1 - phi_2.scaled(3.0) + phi_3.scaled(4.0));
            made.middle[l] = h.scaled(2.0) * (phi_2 - phi_3.scaled(2.0));
            made.last[l] = h * (phi_3.scaled(4.0) - phi_2);
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phi_functions_meet_at_the_switch_and_their_definitions() {
        for z in [-1e-9, -0.01, -0.699, -0.701, -3.0, -50.0] {
            let (_, [phi_1, phi_2, phi_3]) = phi(z);
            // By quadrature: phi_k = integral_0^1 e^((1-s) z) s^(k-1) / (k-1)! ds.
            let n = 20_000;
            let mut sums = [0.0; 3];
            for j in 0..n {
                let s = (f64::from(j) + 0.5) / f64::from(n);
                let e = ((1.0 - s) * z).exp() / f64::from(n);
                sums[0] += e;
                sums[1] += e * s;
                sums[2] += e * s * s / 2.0;
            }
            // The midpoint rule errs by the change of the slope over 24 n^2.
            let tolerance = 1e-12 + (2.0 + z * z) / 24.0 / f64::from(n).powi(2);
            for (found, expected) in [phi_1, phi_2, phi_3].into_iter().zip(sums) {
                assert!((found - expected).abs() < tolerance, "z = {z}: {found}, {expected}");
            }
        }
    }

    #[test]
    fn without_decay_the_weights_are_the_classical_ones() {
        let c = Exponential::<f64, 1>::new(&[0.0], 0.6);
        assert!((c.first[0] - 0.1).abs() < 1e-16);
        assert!((c.middle[0] - 0.2).abs() < 1e-16);
        assert!((c.last[0] - 0.1).abs() < 1e-16);
        assert_eq!((c.half[0], c.whole[0], c.stage[0]), (1.0, 1.0, 0.3));
    }
}
