//! Lobatto's nodes on [0, 1]: both ends, and where between them a polynomial through the values at
//! the nodes is integrated best.

use std::sync::LazyLock;

use drivescope_numerics::Real;

/// Nodes of a step: as many as one vector of the widest instructions holds.
pub(super) const NODES: usize = 8;
/// Degree of the polynomial through them.
const DEGREE: usize = NODES - 1;
/// Newton's method doubles the digits at each: from Chebyshev's nodes four are enough.
const CORRECTIONS: usize = 8;

/// Where they are, and what follows from values there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Nodes {
    /// In ascending order.
    pub(super) places: [f64; NODES],
    /// `coefficients[k][m]`: of t^m in the polynomial that is 1 at node k and 0 at the others.
    pub(super) coefficients: [[f64; NODES]; NODES],
    /// Weights that give Legendre's last two coefficients of the values.
    last: [[f64; NODES]; 2],
}

/// Legendre's polynomials of that degree and the one before, at x.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut now) = (1.0, x);
    for n in 1..degree {
        let n = n as f64;
        (before, now) = (now, ((2.0 * n + 1.0) * x * now - n * before) / (n + 1.0));
    }
    (now, before)
}

/// They are the same for every drive.
static LOBATTO: LazyLock<Nodes> = LazyLock::new(Nodes::new);

impl Nodes {
    /// Lobatto's nodes.
    pub(super) fn lobatto() -> &'static Self {
        &LOBATTO
    }

    fn new() -> Self {
        let on_both_sides: [f64; NODES] = std::array::from_fn(|k| {
            let mut x = -(std::f64::consts::PI * k as f64 / DEGREE as f64).cos();
            for _ in 0..CORRECTIONS {
                // The derivative of P_n vanishes where x P_n = P_(n-1) does; so do the ends.
                let (last, before) = legendre(DEGREE, x);
                x -= (x * last - before) / (NODES as f64 * last);
            }
            x
        });
        let places = on_both_sides.map(|x| 0.5 * (1.0 + x));
        let coefficients = std::array::from_fn(|k| {
            let mut product = [0.0; NODES];
            product[0] = 1.0;
            for (_, place) in places.iter().enumerate().filter(|(j, _)| *j != k) {
                let length = places[k] - place;
                for m in (0..NODES).rev() {
                    let lower = if m == 0 { 0.0 } else { product[m - 1] };
                    product[m] = (lower - place * product[m]) / length;
                }
            }
            product
        });
        let last = on_both_sides.map(|x| {
            let (seventh, sixth) = legendre(DEGREE, x);
            let weight = 2.0 / (NODES * DEGREE) as f64 / (seventh * seventh);
            // Of the highest degree the rule gives the norm 2 / n in place of 2 / (2 n + 1).
            let degree = DEGREE as f64;
            [weight * sixth * (2.0 * degree - 1.0) / 2.0, weight * seventh * degree / 2.0]
        });
        let last = [0, 1].map(|of| last.map(|both| both[of]));
        Self { places, coefficients, last }
    }

    /// Coefficients of the polynomial through those values, the lowest first.
    pub(super) fn polynomial(&self, values: &[f64; NODES]) -> [f64; NODES] {
        let mut sum = [0.0; NODES];
        for (basis, value) in self.coefficients.iter().zip(values) {
            for (sum, coefficient) in sum.iter_mut().zip(basis) {
                *sum += value * coefficient;
            }
        }
        sum
    }

    /// The last two of Legendre's coefficients of the values, summed, and the greatest value: what the
    /// polynomial leaves out is less than these.
    #[inline(always)]
    pub(super) fn tail<R: Real>(&self, values: &[R; NODES]) -> (f64, f64) {
        let mut sums = [0.0; 2];
        let mut greatest = 0.0;
        for node in 0..NODES {
            let value = values[node].value();
            sums[0] += self.last[0][node] * value;
            sums[1] += self.last[1][node] * value;
            let size = value.abs();
            greatest = if size > greatest { size } else { greatest };
        }
        (sums[0].abs() + sums[1].abs(), greatest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nodes_integrate_a_polynomial_of_degree_thirteen_and_interpolate_one_of_seven() {
        let nodes = Nodes::lobatto();
        assert_eq!((nodes.places[0], nodes.places[NODES - 1]), (0.0, 1.0));
        // The mean of each basis polynomial is the weight of its node.
        let weights = nodes
            .coefficients
            .map(|row| row.iter().zip(1..).map(|(c, power)| c / f64::from(power)).sum::<f64>());
        for degree in 0..14 {
            let terms = weights.iter().zip(&nodes.places).map(|(w, t)| w * t.powi(degree));
            let mean = 1.0 / f64::from(degree + 1);
            assert!((terms.sum::<f64>() - mean).abs() < 1e-11, "degree {degree}");
        }
        for degree in 0..8 {
            let value = |t: f64| t.powi(degree);
            let at = |t: f64| -> f64 {
                let basis = nodes.coefficients.iter().zip(&nodes.places);
                let of = |row: &[f64; NODES]| row.iter().rev().fold(0.0, |sum, c| sum * t + c);
                basis.map(|(row, place)| of(row) * value(*place)).sum()
            };
            assert!((at(0.37) - value(0.37)).abs() < 1e-11, "degree {degree}");
        }
    }

    #[test]
    fn the_tail_is_long_where_the_values_are_not_smooth() {
        let nodes = Nodes::lobatto();
        let tail = |f: fn(f64) -> f64| nodes.tail(&nodes.places.map(f)).0;
        assert!(tail(|t| 1.0 + t.powi(5)) < 1e-13);
        assert!(tail(|t| (-3.0 * t).exp()) < 1e-3);
        assert!(tail(|t| (t - 0.4).abs()) > 1e-3);
    }

    #[test]
    fn the_last_coefficients_are_legendres() {
        let nodes = Nodes::lobatto();
        let of = |degree| nodes.tail(&nodes.places.map(|t| legendre(degree, 2.0 * t - 1.0).0)).0;
        assert!((of(6) - 1.0).abs() < 1e-13 && (of(7) - 1.0).abs() < 1e-13);
        assert!(of(5) < 1e-13);
    }
}
