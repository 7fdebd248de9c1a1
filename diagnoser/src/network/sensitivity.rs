//! Exact derivatives of the free run with respect to every parameter, by forward recursion.
//!
//! The network's structure keeps them cheap. In a filter xi(k) = s(k) - sum_l a_l xi(k-l) all
//! d xi(k) / d a_m are delays of one sequence, z(k) = -xi(k-1) - sum_l a_l z(k-l), and
//! d xi(k) / d w_j is the same filter fed with u_j: one more filter a neuron and one an input,
//! whatever the number of parameters. The second layer has no feedback: its derivatives are
//! delayed products of what the free run computes anyhow.

use drivescope_numerics::Linearisation;
use nalgebra::DMatrix;

use super::run::{State, Weights, shift_in, sum_of_products};
use super::theta::Layers;
use super::{Structure, Theta};

/// Samples whose derivatives are gathered at once: a block of 50 parameters fits the cache.
const BLOCK: usize = 256;

/// The free run together with its derivatives.
struct Tangent {
    weights: Weights,
    state: State,
    /// Per IIR neuron (2 r - 1) rows of r: what z(k-1), z(k-2).. add to d activation / d theta_j.
    delays_to_theta: Vec<f64>,
    /// Per output and delay, v1 factors: the collapsed weight of sigma_i(k-l) in y_o(k).
    collapsed: Vec<f64>,
    /// x1 before the step.
    before: Vec<f64>,
    /// z, newest first: 2 r - 1 delays per IIR neuron.
    z: Vec<f64>,
    /// d xi / d w_j, newest first: r delays per IIR neuron and input.
    eta: Vec<f64>,
    /// d sigma / d (parameters of layer one) at the last r samples, newest first.
    d_sigma: Vec<Vec<f64>>,
    /// [sigma; u] at the last r samples, newest first.
    fed: Vec<Vec<f64>>,
}

impl Tangent {
    fn new(structure: Structure, values: &[f64]) -> Self {
        let layers = Layers::of(structure, values);
        let weights = Weights::of_layers(layers);
        let Structure { inputs, outputs, v1, v2, order } = structure;
        let span = 2 * order - 1;
        let mut delays_to_theta = Vec::with_capacity(v1 * span * order);
        for neuron in layers.neurons() {
            let derivatives = neuron.denominator_derivatives();
            let entry = |delay: usize, j: usize| -> f64 {
                // d activation / d a_m = sum_l b_l z(k - l - m + 1).
                let pairs = (0..order).filter(|l| delay >= *l && delay - l < order);
                pairs.map(|l| neuron.b[l] * derivatives[delay - l][j]).sum()
            };
            for delay in 0..span {
                delays_to_theta.extend((0..order).map(|j| entry(delay, j)));
            }
        }
        let columns = v1 + inputs;
        let mut collapsed = Vec::with_capacity(outputs * order * v1);
        for row in weights.c.chunks_exact(v2 * order) {
            for delay in 0..order {
                for i in 0..v1 {
                    let through = |j: usize| row[j * order + delay] * weights.fir[j * columns + i];
                    collapsed.push((0..v2).map(through).sum());
                }
            }
        }
        let first_layer = v1 * structure.iir_parameters();
        Self {
            state: State::at_rest(structure),
            delays_to_theta,
            collapsed,
            before: vec![0.0; v1 * order],
            z: vec![0.0; v1 * span],
            eta: vec![0.0; v1 * inputs * order],
            d_sigma: vec![vec![0.0; first_layer]; order],
            fed: vec![vec![0.0; columns]; order],
            weights,
        }
    }

    /// Advances by one sample; writes d y_o(k) / d parameters into one slice an output.
    #[inline]
    fn step<'a>(&mut self, u: &[f64], into: impl Iterator<Item = &'a mut [f64]>) {
        self.output_derivatives(into);
        self.before.copy_from_slice(&self.state.x1);
        self.state.step(&self.weights, u.iter().copied());
        self.remember(u);
    }

    /// Derivatives of y(k), which depends on samples before k alone.
    #[inline]
    fn output_derivatives<'a>(&self, into: impl Iterator<Item = &'a mut [f64]>) {
        let structure = self.weights.structure;
        let Structure { inputs, v1, v2, order, .. } = structure;
        let (own, columns) = (structure.iir_parameters(), v1 + inputs);
        for (o, column) in into.enumerate() {
            let (layer_one, rest) = column.split_at_mut(v1 * own);
            let (fir, c) = rest.split_at_mut(v2 * columns);
            let taps = &self.weights.c[o * v2 * order..][..v2 * order];
            for delay in 0..order {
                let factors = &self.collapsed[(o * order + delay) * v1..][..v1];
                let neurons =
                    layer_one.chunks_exact_mut(own).zip(self.d_sigma[delay].chunks_exact(own));
                for ((slice, d_sigma), factor) in neurons.zip(factors) {
                    scaled_into(slice, *factor, d_sigma, delay > 0);
                }
                for (slice, taps) in fir.chunks_exact_mut(columns).zip(taps.chunks_exact(order)) {
                    scaled_into(slice, taps[delay], &self.fed[delay], delay > 0);
                }
            }
            c.fill(0.0);
            c[o * v2 * order..][..v2 * order].copy_from_slice(&self.state.x2);
        }
    }

    /// Derivatives of sigma(k), kept for the next r outputs.
    #[inline]
    fn remember(&mut self, u: &[f64]) {
        let weights = &self.weights;
        let structure = weights.structure;
        let Structure { inputs, order, .. } = structure;
        let (own, span) = (structure.iir_parameters(), 2 * order - 1);
        self.d_sigma.rotate_right(1);
        self.fed.rotate_right(1);
        self.fed[0].copy_from_slice(&self.state.fed);
        for (i, d_sigma) in self.d_sigma[0].chunks_exact_mut(own).enumerate() {
            let (a, b) = (&weights.a[i * order..][..order], &weights.b[i * order..][..order]);
            let xi = &self.before[i * order..][..order];
            let sigma = self.state.fed[i];
            let slope = 1.0 - sigma * sigma;
            let gain = slope * weights.g_2[i];
            let (to_w, rest) = d_sigma.split_at_mut(inputs);
            let (to_theta, rest) = rest.split_at_mut(order);
            let (to_b, last) = rest.split_at_mut(order);
            let etas = self.eta[i * inputs * order..][..inputs * order].chunks_exact_mut(order);
            for ((to_w, eta), u) in to_w.iter_mut().zip(etas).zip(u) {
                *to_w = gain * (weights.b_0[i] * u + sum_of_products(b, eta));
                let next = u - sum_of_products(a, eta);
                shift_in(eta, next);
            }
            let z = &mut self.z[i * span..][..span];
            let matrix = &self.delays_to_theta[i * span * order..][..span * order];
            for (j, to_theta) in to_theta.iter_mut().enumerate() {
                let column = matrix[j..].iter().step_by(order);
                *to_theta = gain * z.iter().zip(column).map(|(z, p)| z * p).sum::<f64>();
            }
            let next = -xi[0] - sum_of_products(a, &z[..order]);
            shift_in(z, next);
            for (to_b, xi) in to_b.iter_mut().zip(xi) {
                *to_b = gain * xi;
            }
            last[0] = gain * self.state.drive[i];
            last[1] = -gain;
            last[2] = slope * self.state.activation[i];
        }
    }
}

/// slice = factor x values, or slice += factor x values.
#[inline]
fn scaled_into(slice: &mut [f64], factor: f64, values: &[f64], add: bool) {
    let pairs = slice.iter_mut().zip(values);
    if add {
        pairs.for_each(|(s, v)| *s += factor * v);
    } else {
        pairs.for_each(|(s, v)| *s = factor * v);
    }
}

impl Theta {
    /// Outputs over standardised inputs (row after row): one row of outputs a sample.
    pub fn simulate(&self, inputs: &[f64]) -> Vec<f64> {
        let weights = Weights::of_layers(Layers::of(self.structure, &self.values));
        let mut state = State::at_rest(self.structure);
        let mut outputs =
            Vec::with_capacity(inputs.len() / self.structure.inputs * self.structure.outputs);
        for u in inputs.chunks_exact(self.structure.inputs) {
            state.step(&weights, u.iter().copied());
            outputs.extend_from_slice(&state.y);
        }
        outputs
    }

    /// Derivatives of the same outputs: parameters x (samples x outputs).
    pub fn jacobian(&self, inputs: &[f64]) -> DMatrix<f64> {
        let Structure { inputs: n, outputs: m, .. } = self.structure;
        let p = self.structure.parameters();
        let mut columns = vec![0.0; p * m * (inputs.len() / n)];
        let mut tangent = Tangent::new(self.structure, &self.values);
        for (u, columns) in inputs.chunks_exact(n).zip(columns.chunks_exact_mut(p * m)) {
            tangent.step(u, columns.chunks_exact_mut(p));
        }
        DMatrix::from_vec(p, m * (inputs.len() / n), columns)
    }
}

/// Sum of squared free-run errors, from sample `run_up` on.
pub(super) fn sse(
    structure: Structure,
    values: &[f64],
    inputs: &[f64],
    outputs: &[f64],
    run_up: usize,
) -> f64 {
    let weights = Weights::of_layers(Layers::of(structure, values));
    let mut state = State::at_rest(structure);
    let rows = inputs.chunks_exact(structure.inputs).zip(outputs.chunks_exact(structure.outputs));
    let mut sum = 0.0;
    for (k, (u, measured)) in rows.enumerate() {
        state.step(&weights, u.iter().copied());
        if k >= run_up {
            sum += state.y.iter().zip(measured).map(|(y, m)| (y - m) * (y - m)).sum::<f64>();
        }
    }
    sum
}

/// The same with J^T J and J^T r, gathered block by block.
pub(super) fn linearise(
    structure: Structure,
    values: &[f64],
    inputs: &[f64],
    outputs: &[f64],
    run_up: usize,
) -> Linearisation {
    let (p, m) = (values.len(), structure.outputs);
    let mut gathered = Linearisation::new(p);
    let mut tangent = Tangent::new(structure, values);
    let mut columns = vec![0.0; p * m * BLOCK];
    let mut residuals = Vec::with_capacity(m * BLOCK);
    let rows = inputs.chunks_exact(structure.inputs).zip(outputs.chunks_exact(m));
    for (k, (u, measured)) in rows.enumerate() {
        let at = residuals.len() * p;
        tangent.step(u, columns[at..][..p * m].chunks_exact_mut(p));
        if k >= run_up {
            residuals.extend(tangent.state.y.iter().zip(measured).map(|(y, m)| y - m));
        }
        if residuals.len() == m * BLOCK {
            gathered.add(&DMatrix::from_column_slice(p, m * BLOCK, &columns), &residuals);
            residuals.clear();
        }
    }
    if !residuals.is_empty() {
        let filled = &columns[..p * residuals.len()];
        gathered.add(&DMatrix::from_column_slice(p, residuals.len(), filled), &residuals);
    }
    gathered
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::noise;

    /// Central differences with a step of 1e-5 over filters of moderate memory: 1e-10 of truncation
    /// times third derivatives of up to 1e2, 1e-11 of rounding.
    const DIFFERENCE: f64 = 1e-7;

    fn drawn(structure: Structure, seed: u64) -> Theta {
        let mut draws = noise(1000, seed).into_iter();
        Theta::draw(structure, || draws.next().unwrap())
    }

    #[test]
    fn derivatives_equal_differences_for_all_sizes() {
        let structures = [
            Structure::PAPER,
            Structure { order: 2, ..Structure::PAPER },
            Structure { inputs: 2, outputs: 2, v1: 2, v2: 3, order: 3 },
        ];
        for (seed, structure) in structures.into_iter().enumerate() {
            let values = noise(structure.parameters(), seed as u64);
            let theta = Theta { structure, values: values.iter().map(|e| 0.5 * e).collect() };
            let inputs = noise(60 * structure.inputs, 9);
            let jacobian = theta.jacobian(&inputs);
            let h = 1e-5;
            for p in 0..structure.parameters() {
                let (mut up, mut down) = (theta.clone(), theta.clone());
                up.values[p] += h;
                down.values[p] -= h;
                let differences = up.simulate(&inputs).into_iter().zip(down.simulate(&inputs));
                for (column, (u, d)) in differences.enumerate() {
                    let (exact, difference) = (jacobian[(p, column)], (u - d) / (2.0 * h));
                    assert!(
                        (exact - difference).abs() < DIFFERENCE * (1.0 + exact.abs()),
                        "{structure:?}, parameter {p}, column {column}: {exact}, {difference}"
                    );
                }
            }
        }
    }

    #[test]
    fn gathered_blocks_equal_the_whole_jacobian() {
        let structure = Structure { outputs: 2, ..Structure::PAPER };
        let (theta, run_up) = (drawn(structure, 4), 30);
        let samples = 2 * BLOCK + 100;
        let (inputs, measured) = (noise(samples, 5), noise(2 * samples, 6));
        let gathered = linearise(structure, &theta.values, &inputs, &measured, run_up);
        let jacobian =
            theta.jacobian(&inputs).columns(2 * run_up, 2 * (samples - run_up)).into_owned();
        let residuals: Vec<f64> =
            theta.simulate(&inputs).iter().zip(&measured).map(|(y, m)| y - m).collect();
        let mut whole = Linearisation::new(theta.values.len());
        whole.add(&jacobian, &residuals[2 * run_up..]);
        let scale = whole.hessian.norm();
        assert!((&gathered.hessian - &whole.hessian).norm() < 1e-12 * scale);
        assert!((&gathered.gradient - &whole.gradient).norm() < 1e-12 * whole.gradient.norm());
        assert!((gathered.sse / whole.sse - 1.0).abs() < 1e-12);
        let plain = sse(structure, &theta.values, &inputs, &measured, run_up);
        assert!((plain / whole.sse - 1.0).abs() < 1e-12);
    }
}
