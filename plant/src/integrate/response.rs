//! How a motor responds, exactly, to a start and to what the laws add to its rates, given at nodes:
//!
//!   y(c h) = e^(A c h) y(0) + .. + h sum_m c^(m+1) m! phi_(m+1)(A c h) d_m,  g = sum_m d_m (t / h)^m

use drivescope_numerics::Real;

use super::affine::Continuous;
use super::nodes::{NODES, Nodes};
use crate::model::{Applied, CURRENT, OWN, POSITION, SPEED};

/// Fastest rate of the motor times the step at most, for the series for phi ends after [`TERMS`].
pub(super) const RADIANS: f64 = 5.0;
/// 5^28 9! / 37! is 1e-18.
const TERMS: usize = 28;

/// What a value at every node is.
pub(super) type AtNodes<R> = [R; NODES];

/// A 2 x 2 matrix.
type Square<R> = [[R; 2]; 2];

/// `z x + unit I`.
fn product_and_unit<R: Real>(z: &Square<R>, x: &Square<R>, unit: f64) -> Square<R> {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let sum = z[row][0] * x[0][column] + z[row][1] * x[1][column];
            if row == column { sum + R::constant(unit) } else { sum }
        })
    })
}

/// 1 / k!.
const INVERSE_FACTORIALS: [f64; TERMS + NODES + 1] = {
    let mut all = [1.0; TERMS + NODES + 1];
    let mut k = 1;
    while k < all.len() {
        all[k] = all[k - 1] / k as f64;
        k += 1;
    }
    all
};

/// phi_0 = e^z to phi_(NODES + 1): phi_k = z phi_(k+1) + 1 / k!, the last as a series.
fn phi<R: Real>(z: &Square<R>) -> [Square<R>; NODES + 2] {
    let mut last = [[R::zero(); 2]; 2];
    for inverse in INVERSE_FACTORIALS[NODES + 1..].iter().rev() {
        last = product_and_unit(z, &last, *inverse);
    }
    let mut all = [last; NODES + 2];
    for k in (0..=NODES).rev() {
        all[k] = product_and_unit(z, &all[k + 1], INVERSE_FACTORIALS[k]);
    }
    all
}

/// What the state at one place in the step follows from.
pub(super) struct At<R> {
    /// `flow[row][column]`; columns current, speed, u, load.
    pub(super) flow: [[R; 4]; OWN],
    /// `response[node of it][rate][row]`.
    pub(super) response: [[[R; OWN]; 2]; NODES],
}

impl<R: Real> At<R> {
    /// `place` is the share of the step `h` that has passed.
    pub(super) fn new(motor: &Continuous<R>, nodes: &Nodes, h: R, place: f64) -> Self {
        let passed = h.scaled(place);
        let phi = phi(&motor.a.map(|row| row.map(|rate| rate * passed)));
        // To inputs that grow with that power of time; the position is the integral of the speed.
        let rows = |power: usize| {
            let [now, next] = [phi[power + 1], phi[power + 2]];
            [now[0], now[1], next[1].map(|x| x * passed)]
        };
        let mut made =
            Self { flow: [[R::zero(); 4]; OWN], response: [[[R::zero(); OWN]; 2]; NODES] };
        let free = [phi[0][0], phi[0][1], phi[1][1].map(|x| x * passed)];
        let held = rows(0).map(|row| row.map(|x| x * passed));
        for row in 0..OWN {
            for column in 0..2 {
                made.flow[row][column] = free[row][column];
                let [b, d] = [motor.b[0][column], motor.b[1][column]];
                made.flow[row][2 + column] = held[row][0] * b + held[row][1] * d;
            }
        }
        // m! c^(m+1).
        let mut weight = place;
        for power in 0..NODES {
            weight *= if power == 0 { 1.0 } else { power as f64 * place };
            let rows = rows(power);
            for (response, coefficients) in made.response.iter_mut().zip(&nodes.coefficients) {
                let share = h.scaled(weight * coefficients[power]);
                for rate in 0..2 {
                    for row in 0..OWN {
                        response[rate][row] += share * rows[row][rate];
                    }
                }
            }
        }
        made
    }

    /// The state there.
    pub(super) fn state(
        &self,
        start: [R; OWN],
        applied: &Applied<R, 1>,
        added: &[AtNodes<R>],
    ) -> [R; OWN] {
        let acting = [start[CURRENT], start[SPEED], applied.u[0], applied.load[0]];
        std::array::from_fn(|row| {
            let mut sum = if row == POSITION { start[POSITION] } else { R::zero() };
            for (share, value) in self.flow[row].iter().zip(acting) {
                sum += *share * value;
            }
            for (of, response) in self.response.iter().enumerate() {
                sum += response[0][row] * added[0][of] + response[1][row] * added[1][of];
            }
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y' = a y + (1, t^2) decoupled, by hand.
    #[test]
    fn the_response_to_a_polynomial_is_exact() {
        let (decay, h) = (300.0, 0.01);
        let b = [[0.0; 3]; 2];
        let motor = Continuous { a: [[-decay, 0.0], [0.0, 0.0]], b };
        let nodes = Nodes::lobatto();
        let added = [[1.0; NODES], nodes.places.map(|place| (place * h).powi(2))];
        for place in [0.2, 0.7, 1.0] {
            let t: f64 = place * h;
            let applied = Applied { u: [0.0], load: [0.0], time: 0.0 };
            let found = At::new(&motor, nodes, h, place).state([2.0, 3.0, 1.0], &applied, &added);
            let left = (-decay * t).exp();
            let expected = [
                2.0 * left + (1.0 - left) / decay,
                3.0 + t.powi(3) / 3.0,
                1.0 + 3.0 * t + t.powi(4) / 12.0,
            ];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-13, "at {place}: {found}, {expected}");
            }
        }
    }
}
