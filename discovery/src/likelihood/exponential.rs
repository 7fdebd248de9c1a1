//! What a linear system does over a sample: x(h) = x(0) + G f, with f its rates at the beginning, and
//! in the mean x(0) + M f.
//!
//! exp(A h) = 1 + A G; G = h phi_1(A h), M = h phi_2(A h) with phi_1(z) = (e^z - 1) / z and
//! phi_2(z) = (phi_1(z) - 1) / z, by a series for a small part of the sample and doubling (Moler and
//! Van Loan, SIAM Review 45, 2003, method 3).

use super::filter::Square;

/// Norm of the part of the sample for which the series is summed; six terms leave 1e-9 of it.
const SMALL: f64 = 0.1;
const TERMS: u32 = 7;

/// exp(A h), G and M of a sample, and for which A they were made: most are equal to the ones before.
pub(super) struct Exponential {
    rates: Square,
    h: f64,
    pub(super) whole: Square,
    pub(super) input: Square,
    pub(super) mean: Square,
}

impl Exponential {
    pub(super) fn new() -> Self {
        let none = Square::zeros();
        Self { rates: none, h: 0.0, whole: Square::identity(), input: none, mean: none }
    }

    /// Of that matrix of rates over `h` seconds.
    pub(super) fn set(&mut self, rates: &Square, h: f64) {
        if *rates == self.rates && h == self.h {
            return;
        }
        (self.rates, self.h) = (*rates, h);
        let norm = h * rates.row_iter().map(|row| row.abs().sum()).fold(0.0, f64::max);
        let doublings =
            if norm > SMALL { (norm / SMALL).log2().ceil().min(60.0) as i32 } else { 0 };
        let z = rates * (h / 2.0_f64.powi(doublings));
        let one = Square::identity();
        // phi_2 = 1/2 (1 + z/3 (1 + z/4 (1 + ..))), by Horner.
        let mut second = one;
        for term in (3..=TERMS).rev() {
            second = one + z * second / f64::from(term);
        }
        second *= 0.5;
        let mut first = one + z * second;
        let mut whole = one + z * first;
        for _ in 0..doublings {
            second = 0.25 * (first * first + 2.0 * second);
            first = 0.5 * (whole + one) * first;
            whole *= whole;
        }
        (self.whole, self.input, self.mean) = (whole, h * first, h * second);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decay_and_a_rotation_are_exact() {
        let mut rates = Square::zeros();
        rates[(0, 0)] = -700.0;
        (rates[(1, 2)], rates[(2, 1)]) = (40.0, -40.0);
        let (h, mut e) = (0.01, Exponential::new());
        e.set(&rates, h);
        assert!((e.whole[(0, 0)] - (-7.0_f64).exp()).abs() < 1e-9);
        assert!((e.input[(0, 0)] - (1.0 - (-7.0_f64).exp()) / 700.0).abs() < 1e-11);
        assert!((e.whole[(1, 1)] - 0.4_f64.cos()).abs() < 1e-9);
        assert!((e.whole[(1, 2)] - 0.4_f64.sin()).abs() < 1e-9);
        assert!((e.input[(1, 1)] - 0.4_f64.sin() / 40.0).abs() < 1e-11);
        assert!((e.mean[(1, 1)] - (1.0 - 0.4_f64.cos()) / (1600.0 * h)).abs() < 1e-11);
        assert!((e.input[(3, 3)] - h).abs() < 1e-15 && (e.mean[(3, 3)] - 0.5 * h).abs() < 1e-15);
    }
}
