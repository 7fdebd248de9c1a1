//! Free-run errors of connected neurons with exact derivatives, for Levenberg-Marquardt.
//!
//! Neurons feed only later ones, so that each is simulated over the whole recording at once. A
//! derivative of q obeys the neuron's own recursion, dq = f - a_1 dq(k-1) - .., where f is the
//! regressor for an own parameter and sum_j b_j0 ds_j(k) + .. for one of a neuron before it. Fitting
//! a single neuron and retraining the whole network are the same problem with one or all units.

use drivescope_numerics::{Linearisation, Residuals};
use nalgebra::DMatrix;

use super::series::Series;
use super::{Activation, NeuronOrders};
use crate::stability::step_down;

/// What a unit is fed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Feed {
    /// A variable of the recordings.
    Variable(usize),
    /// A unit before it.
    Unit(usize),
}

/// A neuron in a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    pub(super) feeds: [Feed; 2],
    pub(super) activation: Activation,
}

/// The free-run error of the last unit over recordings, as a function of all parameters.
pub(super) struct FreeRun<'a> {
    pub(super) units: &'a [Unit],
    pub(super) orders: NeuronOrders,
    /// Longest memory of a filter, samples.
    pub(super) memory: f64,
    pub(super) recordings: &'a [Series],
}

/// q and s of a unit over a recording.
pub(super) struct Response {
    pub(super) q: Vec<f64>,
    pub(super) s: Vec<f64>,
}

impl FreeRun<'_> {
    /// Responses of all units to one recording.
    pub(super) fn simulate(&self, values: &[f64], recording: &Series) -> Vec<Response> {
        let count = self.orders.parameters();
        let mut responses: Vec<Response> = Vec::with_capacity(self.units.len());
        for (unit, p) in self.units.iter().zip(values.chunks_exact(count)) {
            let mut forcing = vec![p[count - 1]; recording.y.len()];
            for (j, feed) in unit.feeds.iter().enumerate() {
                let fed = match *feed {
                    Feed::Variable(v) => &recording.variables[v],
                    Feed::Unit(u) => &responses[u].s,
                };
                add_taps(&mut forcing, &p[self.orders.taps(j)], fed);
            }
            filter(&mut forcing, &p[..self.orders.n_a]);
            let s = forcing.iter().map(|q| unit.activation.value(*q)).collect();
            responses.push(Response { q: forcing, s });
        }
        responses
    }

    /// Whether every filter is stable and forgets within its memory.
    fn is_stable(&self, values: &[f64]) -> bool {
        let n_a = self.orders.n_a;
        values.chunks_exact(self.orders.parameters()).all(|p| forgets(&p[..n_a], self.memory))
    }

    /// Derivatives of the last unit's output: one array a parameter.
    fn derivatives(&self, values: &[f64], recording: &Series, all: &[Response]) -> Vec<Vec<f64>> {
        let (count, samples) = (self.orders.parameters(), recording.y.len());
        let n_a = self.orders.n_a;
        // ds_u / dp for every unit; empty where a parameter does not reach the unit.
        let mut slopes: Vec<Vec<Vec<f64>>> = Vec::with_capacity(self.units.len());
        for (n, (unit, p)) in self.units.iter().zip(values.chunks_exact(count)).enumerate() {
            let Response { q, s } = &all[n];
            let mut own = vec![Vec::new(); values.len()];
            for (parameter, derivative) in own.iter_mut().enumerate().take(n * count) {
                for (j, feed) in unit.feeds.iter().enumerate() {
                    let Feed::Unit(u) = *feed else { continue };
                    if slopes[u][parameter].is_empty() {
                        continue;
                    }
                    derivative.resize(samples, 0.0);
                    add_taps(derivative, &p[self.orders.taps(j)], &slopes[u][parameter]);
                }
            }
            for (i, derivative) in own[n * count..][..count].iter_mut().enumerate() {
                *derivative = self.regressor(unit, i, q, recording, all);
            }
            for derivative in own.iter_mut().filter(|derivative| !derivative.is_empty()) {
                filter(derivative, &p[..n_a]);
                for (d, s) in derivative.iter_mut().zip(s) {
                    *d *= unit.activation.slope(*s);
                }
            }
            slopes.push(own);
        }
        slopes.pop().unwrap_or_default()
    }

    /// Entry i of a unit's regressor over a recording.
    fn regressor(
        &self,
        unit: &Unit,
        i: usize,
        q: &[f64],
        recording: &Series,
        all: &[Response],
    ) -> Vec<f64> {
        let samples = q.len();
        if i + 1 == self.orders.parameters() {
            return vec![1.0; samples];
        }
        if i < self.orders.n_a {
            return delayed(q, i + 1).map(|q| -q).collect();
        }
        let j = usize::from(!self.orders.taps(0).contains(&i));
        let delay = i - self.orders.taps(j).start;
        match unit.feeds[j] {
            Feed::Variable(v) => delayed(&recording.variables[v], delay).collect(),
            Feed::Unit(u) => delayed(&all[u].s, delay).collect(),
        }
    }
}

impl Residuals for FreeRun<'_> {
    fn sse(&self, values: &[f64]) -> f64 {
        if !self.is_stable(values) {
            return f64::INFINITY;
        }
        let of = |recording: &Series| -> f64 {
            let responses = self.simulate(values, recording);
            let last = &responses[responses.len() - 1].s;
            let errors = last.iter().zip(&recording.y).skip(recording.from);
            errors.map(|(s, y)| (s - y) * (s - y)).sum()
        };
        self.recordings.iter().map(of).sum()
    }

    fn linearise(&self, values: &[f64]) -> Linearisation {
        let mut gathered = Linearisation::new(values.len());
        if !self.is_stable(values) {
            gathered.sse = f64::INFINITY;
            return gathered;
        }
        for recording in self.recordings {
            let responses = self.simulate(values, recording);
            let slopes = self.derivatives(values, recording, &responses);
            let from = recording.from;
            let last = &responses[responses.len() - 1].s;
            let errors: Vec<f64> =
                last.iter().zip(&recording.y).skip(from).map(|(s, y)| s - y).collect();
            let mut rows = DMatrix::zeros(values.len(), errors.len());
            for (p, slope) in slopes.iter().enumerate().filter(|(_, slope)| !slope.is_empty()) {
                for (k, slope) in slope[from..].iter().enumerate() {
                    rows[(p, k)] = *slope;
                }
            }
            gathered.add(&rows, &errors);
        }
        gathered
    }
}

/// Whether a filter is stable, with reflection coefficients below 1 - 1 / memory.
pub(super) fn forgets(a: &[f64], memory: f64) -> bool {
    let slow = |k: &f64| k.abs() > 1.0 - 1.0 / memory;
    step_down(a).is_some_and(|reflection| !reflection.iter().any(slow))
}

/// A signal some samples ago, zero before its start.
pub(super) fn delayed(signal: &[f64], delay: usize) -> impl Iterator<Item = f64> {
    std::iter::repeat_n(0.0, delay).chain(signal.iter().copied()).take(signal.len())
}

/// sum += b_0 s(k) + b_1 s(k-1) + ..
fn add_taps(sum: &mut [f64], b: &[f64], s: &[f64]) {
    for (delay, b) in b.iter().enumerate() {
        sum[delay..].iter_mut().zip(s).for_each(|(sum, s)| *sum += b * s);
    }
}

/// q(k) = f(k) - a_1 q(k-1) - .., in place.
fn filter(q: &mut [f64], a: &[f64]) {
    for k in 0..q.len() {
        let mut value = q[k];
        for (l, a) in a.iter().enumerate().take(k) {
            value -= a * q[k - l - 1];
        }
        q[k] = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::noise;

    #[test]
    fn derivatives_equal_differences() {
        let orders = NeuronOrders { n_a: 2, n_b: 1 };
        let unit = |feeds, activation| Unit { feeds, activation };
        let units = [
            unit([Feed::Variable(0), Feed::Variable(1)], Activation::Tanh),
            unit([Feed::Variable(1), Feed::Variable(2)], Activation::Identity),
            unit([Feed::Unit(0), Feed::Unit(1)], Activation::Tanh),
            unit([Feed::Unit(2), Feed::Unit(0)], Activation::Tanh),
        ];
        let recordings = [1, 2].map(|seed| Series {
            variables: (0..3).map(|v| noise(80, 10 * seed + v)).collect(),
            y: noise(80, 10 * seed + 5),
            from: 7,
        });
        let problem = FreeRun { units: &units, orders, memory: 1e4, recordings: &recordings };
        let values: Vec<f64> = noise(4 * orders.parameters(), 3).iter().map(|e| 0.3 * e).collect();
        let at = problem.linearise(&values);
        assert!((at.sse / problem.sse(&values) - 1.0).abs() < 1e-12);
        let h = 1e-6;
        for p in 0..values.len() {
            let moved = |by: f64| {
                let mut moved = values.clone();
                moved[p] += by;
                problem.sse(&moved)
            };
            let difference = (moved(h) - moved(-h)) / (2.0 * h);
            // Central differences of a sum of 150 squares: 1e-12 of curvature, 1e-8 of rounding.
            assert!((2.0 * at.gradient[p] - difference).abs() < 1e-5, "parameter {p}");
        }
        let mut unstable = values;
        unstable[0] = 5.0;
        assert_eq!(problem.sse(&unstable), f64::INFINITY);
    }
}
