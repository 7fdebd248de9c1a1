//! Least squares over delayed signals, using that every regressor is its neighbour one sample on.
//!
//! The sums of products C_pq(i, j) = sum_k p(k-i) q(k-j) of delayed signals obey
//! C(i+1, j+1) = C(i, j) + p(s-1-i) q(s-1-j) - p(e-1-i) q(e-1-j) over the samples s..e, so that
//! one row and one column of scalar products give all of them. Their Cholesky factor alone would
//! lose half the digits; it serves as the preconditioner of corrected semi-normal equations,
//! whose residuals are taken from the data themselves and which reach the accuracy of QR as long
//! as the factor exists at all. Source: A. Bjorck, Linear Algebra Appl. 88/89 (1987), 31-48.

use nalgebra::{DMatrix, DVector};

use super::Orders;
use crate::data::Data;
use crate::history::dot;

/// Smallest pivot of the Gram matrix of columns of length one: a correction then gains four digits
/// or more. Below it the caller falls back on QR.
const SMALLEST_PIVOT: f64 = 1e-10;
/// Corrections at most; two are the rule.
const CORRECTIONS: usize = 6;
/// A correction this small, relative to the parameters, is rounding.
const NEGLIGIBLE: f64 = 1e-14;
/// A correction must be smaller than the one before by this factor, unless it is negligible.
const PROGRESS: f64 = 1e-2;
/// A stall below this relative size is the accuracy of the data's own scalar products.
const STALL: f64 = 1e-11;

/// Parameters -a, b.., c in the order of the regressors y(k-1).., u_j(k-1).., 1, and the sum of
/// squared errors; `None` if the columns are so close to dependent that QR is called for.
pub(super) fn solve(data: &Data, orders: Orders) -> Option<(Vec<f64>, f64)> {
    let delayed = Delayed::new(data, orders);
    let (mut gram, target) = delayed.products();
    let scale: Vec<f64> = gram.diagonal().iter().map(|square| 1.0 / square.sqrt()).collect();
    for (i, row) in scale.iter().enumerate() {
        for (j, column) in scale.iter().enumerate() {
            gram[(i, j)] *= row * column;
        }
    }
    let factor = gram.cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    if !pivots.iter().all(|pivot| pivot * pivot > SMALLEST_PIVOT) {
        return None;
    }
    let scale = DVector::from_vec(scale);
    let correction = |along: DVector<f64>| {
        let mut step = along.component_mul(&scale);
        factor.solve_mut(&mut step);
        step.component_mul(&scale)
    };
    let mut parameters = correction(target);
    let mut last = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let errors = delayed.errors(&parameters);
        let step = correction(delayed.along(&errors));
        parameters += &step;
        let relative = step.component_div(&scale).norm() / parameters.component_div(&scale).norm();
        if relative <= NEGLIGIBLE || (relative <= STALL && relative > PROGRESS * last) {
            let errors = delayed.errors(&parameters);
            return Some((parameters.as_slice().to_vec(), errors.iter().map(|e| e * e).sum()));
        }
        // Written so that NaN falls back too.
        let progress = relative <= PROGRESS * last;
        if !progress {
            return None;
        }
        last = relative;
    }
    None
}

/// The regressors as delays 1.. of the signals y, u_1.., over the samples from `start` on.
struct Delayed<'a> {
    signals: Vec<(&'a [f64], usize)>,
    constant: bool,
    start: usize,
    columns: usize,
}

impl<'a> Delayed<'a> {
    fn new(data: &Data<'a>, orders: Orders) -> Self {
        let output = (data.output().values, orders.n_a);
        let inputs = data.inputs().iter().map(|column| (column.values, orders.n_b));
        Self {
            signals: [output].into_iter().chain(inputs).collect(),
            constant: orders.constant,
            start: orders.reach(),
            columns: orders.parameters(data.inputs().len()),
        }
    }

    fn end(&self) -> usize {
        self.signals[0].0.len()
    }

    /// p(k-i) over the samples.
    fn delay(&self, signal: &'a [f64], i: usize) -> &'a [f64] {
        &signal[self.start - i..self.end() - i]
    }

    /// X^T X and X^T y.
    fn products(&self) -> (DMatrix<f64>, DVector<f64>) {
        let mut gram = DMatrix::zeros(self.columns, self.columns);
        let mut target = DVector::zeros(self.columns);
        let y = self.delay(self.signals[0].0, 0);
        let ones = vec![1.0; y.len()];
        let last = self.columns - 1;
        let mut row = 0;
        for (p_index, &(p, p_delays)) in self.signals.iter().enumerate() {
            for i in 1..=p_delays {
                target[row + i - 1] = dot(self.delay(p, i), y);
            }
            if self.constant {
                for i in 1..=p_delays {
                    gram[(row + i - 1, last)] = dot(self.delay(p, i), &ones);
                    gram[(last, row + i - 1)] = gram[(row + i - 1, last)];
                }
            }
            let mut column = row;
            for &(q, q_delays) in &self.signals[p_index..] {
                for i in 1..=p_delays {
                    for j in 1..=q_delays {
                        let product = if i == 1 || j == 1 {
                            dot(self.delay(p, i), self.delay(q, j))
                        } else {
                            let (first, end) = (self.start - 1, self.end() - 1);
                            let entering = p[first + 1 - i] * q[first + 1 - j];
                            let leaving = p[end + 1 - i] * q[end + 1 - j];
                            gram[(row + i - 2, column + j - 2)] + entering - leaving
                        };
                        gram[(row + i - 1, column + j - 1)] = product;
                    }
                }
                column += q_delays;
            }
            row += p_delays;
        }
        if self.constant {
            gram[(last, last)] = y.len() as f64;
            target[last] = dot(y, &ones);
        }
        gram.fill_lower_triangle_with_upper_triangle();
        (gram, target)
    }

    /// y - X p.
    fn errors(&self, parameters: &DVector<f64>) -> Vec<f64> {
        let mut errors = self.delay(self.signals[0].0, 0).to_vec();
        let mut parameters = parameters.iter();
        for &(signal, delays) in &self.signals {
            for (i, p) in (1..=delays).zip(&mut parameters) {
                let regressor = self.delay(signal, i);
                errors.iter_mut().zip(regressor).for_each(|(e, r)| *e -= p * r);
            }
        }
        if let Some(constant) = parameters.next() {
            errors.iter_mut().for_each(|e| *e -= constant);
        }
        errors
    }

    /// X^T e.
    fn along(&self, errors: &[f64]) -> DVector<f64> {
        let delays = self.signals.iter().flat_map(|&(signal, delays)| {
            (1..=delays).map(move |i| dot(self.delay(signal, i), errors))
        });
        let constant = self.constant.then(|| errors.iter().sum());
        DVector::from_iterator(self.columns, delays.chain(constant))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arx::fit::equations;
    use crate::data::Column;
    use crate::testing::{closed_loop, noise};

    const ORDERS: Orders = Orders { n_a: 5, n_b: 3, constant: true };

    #[test]
    fn equals_orthogonal_triangularisation() {
        let run = closed_loop(2000, 1, usize::MAX, 0.0);
        let other = noise(2000, 2);
        let inputs = vec![
            Column { name: "C_m", values: &run.control },
            Column { name: "other", values: &other },
        ];
        let data = Data::new(inputs, Column { name: "T", values: &run.speed }).unwrap();
        for orders in [
            ORDERS,
            Orders { n_a: 0, n_b: 2, constant: true },
            Orders { n_a: 2, n_b: 0, constant: false },
            Orders { n_a: 20, n_b: 20, constant: true },
        ] {
            let settled = data.span(500..2000);
            let (fast, sse) = solve(&settled, orders).unwrap();
            let qr = equations(&settled, orders).unwrap().solve().unwrap();
            assert!((sse / qr.sse - 1.0).abs() < 1e-11, "{sse} against {}", qr.sse);
            let length = qr.parameters.iter().map(|p| p * p).sum::<f64>().sqrt();
            for (k, (fast, qr)) in fast.iter().zip(&qr.parameters).enumerate() {
                let sign = if k < orders.n_a { -1.0 } else { 1.0 };
                // Condition 5e3 times the rounding of a few thousand products.
                assert!((sign * fast - qr).abs() < 1e-10 * length, "{k}: {fast}, {qr}");
            }
        }
    }

    #[test]
    fn close_to_dependent_columns_are_left_to_qr() {
        let u = noise(300, 3);
        let twin: Vec<f64> = u.iter().zip(noise(300, 4)).map(|(u, e)| u + 1e-7 * e).collect();
        let inputs = vec![Column { name: "u", values: &u }, Column { name: "v", values: &twin }];
        let y = noise(300, 5);
        let data = Data::new(inputs, Column { name: "y", values: &y }).unwrap();
        assert_eq!(solve(&data, ORDERS), None);
        let huge: Vec<f64> = y.iter().map(|y| 1e200 * y).collect();
        let data = data.with_output("huge", &huge).unwrap();
        assert_eq!(solve(&data, ORDERS), None);
    }
}
