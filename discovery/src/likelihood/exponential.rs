//! What a linear system does over a sample: x(h) = x(0) + G f, with f its rates at the beginning, and
//! in the mean x(0) + M f.
//!
//! exp(A h) = 1 + A G; G = h phi_1(A h), M = h phi_2(A h) with phi_1(z) = (e^z - 1) / z and
//! phi_2(z) = (phi_1(z) - 1) / z, by a series for a small part of the sample and doubling (Moler and
//! Van Loan, SIAM Review 45, 2003, method 3).

use drivescope_numerics::dispatch::{Work, widest};
use drivescope_plant::model::OWN;

use super::rows::{LANES, NO_ROWS, Row, Rows, add, unit};
use super::state::LOAD;

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

    /// Of that matrix of rates over `h` seconds; the disturbances have none.
    pub(super) fn set(&mut self, rates: &Rows, h: f64) {
        if *rates == self.rates && h == self.h {
            return;
        }
        (self.rates, self.h) = (*rates, h);
        let size = |row: &Row| row.iter().map(|value| value.abs()).sum();
        let norm = h * rates.iter().map(size).fold(0.0, f64::max);
        let doublings =
            if norm > SMALL { (norm / SMALL).log2().ceil().min(60.0) as i32 } else { 0 };
        if rates[OWN..LOAD].iter().flatten().all(|rate| *rate == 0.0) {
            widest(Summed::<OWN> { doublings, of: self });
        } else {
            widest(Summed::<LOAD> { doublings, of: self });
        }
    }
}

/// The series of a small part of the sample, doubled so often, of rates in `R` rows.
struct Summed<'a, const R: usize> {
    doublings: i32,
    of: &'a mut Exponential,
}

impl<const R: usize> Work for Summed<'_, R> {
    #[inline(always)]
    fn run(self) {
        let Self { doublings, of } = self;
        let rates = std::array::from_fn(|row| of.rates[row]);
        let z = Above::<R> { rows: rates, below: 0.0 }.scaled(of.h / 2.0_f64.powi(doublings));
        let unit = Above::unit();
        // phi_2 = 1/2 (1 + z/3 (1 + z/4 (1 + ..))), by Horner.
        let mut second = unit;
        for term in (3..=TERMS).rev() {
            second = unit.and(1.0 / f64::from(term), &z.times(&second));
        }
        second = second.scaled(0.5);
        let mut first = unit.and(1.0, &z.times(&second));
        let mut whole = unit.and(1.0, &z.times(&first));
        for _ in 0..doublings {
            second = first.times(&first).and(2.0, &second).scaled(0.25);
            first = whole.and(1.0, &unit).times(&first).scaled(0.5);
            whole = whole.times(&whole);
        }
        (of.whole, of.input, of.mean) =
            (whole.rows(), first.scaled(of.h).rows(), second.scaled(of.h).rows());
    }
}

/// A square matrix whose rows below the first `R` are those of a multiple of the unit matrix.
#[derive(Clone, Copy)]
struct Above<const R: usize> {
    rows: [Row; R],
    below: f64,
}

impl<const R: usize> Above<R> {
    #[inline(always)]
    fn unit() -> Self {
        let unit = unit();
        Self { rows: std::array::from_fn(|row| unit[row]), below: 1.0 }
    }

    #[inline(always)]
    fn times(&self, other: &Self) -> Self {
        // Column after column of the factors, so that each sum stays in a register; row after row, the
        // compiler goes over several rows at once and gathers their lanes from everywhere. No closure: it
        // would be compiled without the instructions of who calls.
        let mut rows = [[0.0; LANES]; R];
        for column in 0..R {
            for (total, factors) in rows.iter_mut().zip(&self.rows) {
                add(total, factors[column], &other.rows[column]);
            }
        }
        let mut below = [other.below; LANES];
        below[..R].fill(0.0);
        for (total, factors) in rows.iter_mut().zip(&self.rows) {
            for lane in 0..LANES {
                total[lane] += below[lane] * factors[lane];
            }
        }
        Self { rows, below: self.below * other.below }
    }

    #[inline(always)]
    fn scaled(mut self, factor: f64) -> Self {
        for row in &mut self.rows {
            for value in row {
                *value *= factor;
            }
        }
        Self { below: factor * self.below, ..self }
    }

    /// With a multiple of another.
    #[inline(always)]
    fn and(mut self, factor: f64, other: &Self) -> Self {
        for (sum, row) in self.rows.iter_mut().zip(&other.rows) {
            add(sum, factor, row);
        }
        Self { below: self.below + factor * other.below, ..self }
    }

    #[inline(always)]
    fn rows(&self) -> Rows {
        let mut rows = NO_ROWS;
        rows[..R].copy_from_slice(&self.rows);
        for place in R..LANES {
            rows[place][place] = self.below;
        }
        rows
    }
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
        assert!((e.input[7][7] - h).abs() < 1e-15 && (e.mean[7][7] - 0.5 * h).abs() < 1e-15);
        // Own states have their rows too.
        (rates[3][4], rates[4][3]) = (40.0, -40.0);
        e.set(&rates, h);
        assert!((e.whole[3][4] - 0.4_f64.sin()).abs() < 1e-9);
        assert!((e.whole[1][2] - 0.4_f64.sin()).abs() < 1e-9);
    }
}
