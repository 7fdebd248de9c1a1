//! What a linear system does over a sample: x(h) = x(0) + G f, with f its rates at the beginning, and
//! in the mean x(0) + M f.
//!
//! exp(A h) = 1 + A G; G = h phi_1(A h), M = h phi_2(A h) with phi_1(z) = (e^z - 1) / z and
//! phi_2(z) = (phi_1(z) - 1) / z, by a series for a small part of the sample and doubling (Moler and
//! Van Loan, SIAM Review 45, 2003, method 3).

use drivescope_numerics::dispatch::{Work, widest};

use super::rows::{NO_ROWS, Row, Rows, add, product, unit};

/// Norm of the part of the sample for which the series is summed; six terms leave 4e-8 of it.
const SMALL: f64 = 0.3;
const TERMS: u32 = 7;

/// exp(A h), G and M of a sample, and for which A they were made: most are equal to the ones before.
pub(super) struct Exponential {
    rates: Rows,
    h: f64,
    pub(super) whole: Rows,
    pub(super) input: Rows,
    pub(super) mean: Rows,
}

impl Exponential {
    pub(super) fn new() -> Self {
        Self { rates: NO_ROWS, h: 0.0, whole: unit(), input: NO_ROWS, mean: NO_ROWS }
    }

    /// Of that matrix of rates over `h` seconds.
    pub(super) fn set(&mut self, rates: &Rows, h: f64) {
        if *rates == self.rates && h == self.h {
            return;
        }
        (self.rates, self.h) = (*rates, h);
        let size = |row: &Row| row.iter().map(|value| value.abs()).sum();
        let norm = h * rates.iter().map(size).fold(0.0, f64::max);
        let doublings =
            if norm > SMALL { (norm / SMALL).log2().ceil().min(60.0) as i32 } else { 0 };
        let z = scaled(rates, h / 2.0_f64.powi(doublings));
        widest(Summed { z: &z, doublings, h, of: self });
    }
}

/// The series of a small part of the sample, doubled so often.
struct Summed<'a> {
    z: &'a Rows,
    doublings: i32,
    h: f64,
    of: &'a mut Exponential,
}

impl Work for Summed<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { z, doublings, h, of } = self;
        // phi_2 = 1/2 (1 + z/3 (1 + z/4 (1 + ..))), by Horner.
        let mut second = unit();
        for term in (3..=TERMS).rev() {
            second = sum(&unit(), 1.0 / f64::from(term), &product(z, &second));
        }
        second = scaled(&second, 0.5);
        let mut first = sum(&unit(), 1.0, &product(z, &second));
        let mut whole = sum(&unit(), 1.0, &product(z, &first));
        for _ in 0..doublings {
            second = scaled(&sum(&product(&first, &first), 2.0, &second), 0.25);
            first = scaled(&product(&sum(&whole, 1.0, &unit()), &first), 0.5);
            whole = product(&whole, &whole);
        }
        (of.whole, of.input, of.mean) = (whole, scaled(&first, h), scaled(&second, h));
    }
}

#[inline(always)]
fn scaled(rows: &Rows, factor: f64) -> Rows {
    rows.map(|row| row.map(|value| factor * value))
}

/// Rows and a multiple of others.
#[inline(always)]
fn sum(rows: &Rows, factor: f64, others: &Rows) -> Rows {
    let mut sum = *rows;
    for (sum, other) in sum.iter_mut().zip(others) {
        add(sum, factor, other);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decay_and_a_rotation_are_exact() {
        let mut rates = NO_ROWS;
        rates[0][0] = -700.0;
        (rates[1][2], rates[2][1]) = (40.0, -40.0);
        let (h, mut e) = (0.01, Exponential::new());
        e.set(&rates, h);
        assert!((e.whole[0][0] - (-7.0_f64).exp()).abs() < 1e-9);
        assert!((e.input[0][0] - (1.0 - (-7.0_f64).exp()) / 700.0).abs() < 1e-11);
        assert!((e.whole[1][1] - 0.4_f64.cos()).abs() < 1e-9);
        assert!((e.whole[1][2] - 0.4_f64.sin()).abs() < 1e-9);
        assert!((e.input[1][1] - 0.4_f64.sin() / 40.0).abs() < 1e-11);
        assert!((e.mean[1][1] - (1.0 - 0.4_f64.cos()) / (1600.0 * h)).abs() < 1e-11);
        assert!((e.input[3][3] - h).abs() < 1e-15 && (e.mean[3][3] - 0.5 * h).abs() < 1e-15);
    }
}
