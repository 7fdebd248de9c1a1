//! Exact derivatives of the free run with respect to every parameter, by forward recursion.
//!
//! The network's structure keeps them cheap. In a filter xi(k) = s(k) - sum_l a_l xi(k-l) all
//! d xi(k) / d a_m are delays of one sequence, z(k) = -xi(k-1) - sum_l a_l z(k-l), and
//! d xi(k) / d w_j is the same filter fed with u_j: one more filter a neuron and one an input,
//! whatever the number of parameters. The second layer has no feedback: its derivatives are
//! delayed products of what the free run computes anyhow.

use drivescope_numerics::Linearisation;
use nalgebra::DMatrix;

use super::layers::{
    FirstLayer, SWEEP, State, Sweep, Weights, shift_in, simulate, sum_of_products,
};
use super::theta::Layers;
use super::{Structure, Theta};

/// The free run together with its derivatives.
struct Tangent {
    weights: Weights,
    state: State,
    /// Per IIR neuron (2 r - 1) rows of r: what z(k-1), z(k-2).. add to d activation / d theta_j.
    delays_to_theta: Vec<f64>,
    /// Per output and delay one factor a parameter of layer one: the collapsed weight of
    /// sigma_i(k-l) in y_o(k), repeated for every parameter of neuron i.
    collapsed: Vec<f64>,
    /// The first layer over the next samples.
    sweep: Sweep,
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
        let Structure { inputs, outputs, v1, v2, order, .. } = structure;
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
        let mut collapsed = Vec::with_capacity(outputs * order * v1 * structure.iir_parameters());
        for row in weights.c.chunks_exact(v2 * order) {
            for delay in 0..order {
                for i in 0..v1 {
                    let through = |j: usize| row[j * order + delay] * weights.fir[j * columns + i];
                    let weight: f64 = (0..v2).map(through).sum();
                    collapsed.extend(std::iter::repeat_n(weight, structure.iir_parameters()));
                }
            }
        }
        let first_layer = v1 * structure.iir_parameters();
        Self {
            state: State::at_rest(structure),
            delays_to_theta,
            collapsed,
            sweep: Sweep::new(structure, SWEEP),
            z: vec![0.0; v1 * span],
            eta: vec![0.0; v1 * inputs * order],
            d_sigma: vec![vec![0.0; first_layer]; order],
            fed: vec![vec![0.0; columns]; order],
            weights,
        }
    }

    /// Advances over rows of inputs, no more than [`SWEEP`]; writes d y_o(k) / d parameters into
    /// one column an output and sample, zero before or written by this, and shows every y(k).
    fn run(&mut self, rows: &[f64], columns: &mut [f64], mut show: impl FnMut(&[f64])) {
        let structure = self.weights.structure;
        let per_sample = structure.outputs * structure.parameters();
        self.sweep.run(&mut self.state, &self.weights, rows);
        for k in 0..rows.len() / structure.inputs {
            let u = &rows[k * structure.inputs..][..structure.inputs];
            self.output_derivatives(&mut columns[k * per_sample..][..per_sample]);
            self.state.feed(&self.weights, self.sweep.at(k).sigma, u);
            show(&self.state.y);
            // The same code twice: with sizes that the compiler knows its short loops vanish.
            match (structure.inputs, structure.order) {
                (1, 1) => self.remember(k, u, 1, 1),
                (inputs, order) => self.remember(k, u, inputs, order),
            }
        }
    }

    /// Derivatives of y(k), which depends on samples before k alone.
    #[inline]
    fn output_derivatives(&self, columns: &mut [f64]) {
        let structure = self.weights.structure;
        let Structure { inputs, v1, v2, order, .. } = structure;
        let (first, fed) = (v1 * structure.iir_parameters(), v1 + inputs);
        let parameters = structure.parameters();
        for o in 0..structure.outputs {
            let column = &mut columns[o * parameters..][..parameters];
            let (layer_one, rest) = column.split_at_mut(first);
            let (fir, c) = rest.split_at_mut(v2 * fed);
            let taps = &self.weights.c[o * v2 * order..][..v2 * order];
            for delay in 0..order {
                let factors = &self.collapsed[(o * order + delay) * first..][..first];
                let terms = factors.iter().zip(&self.d_sigma[delay]).map(|(f, d)| f * d);
                put(layer_one, terms, delay > 0);
                for j in 0..v2 {
                    let tap = taps[j * order + delay];
                    let terms = self.fed[delay].iter().map(|fed| tap * fed);
                    put(&mut fir[j * fed..][..fed], terms, delay > 0);
                }
            }
            // The rows of the other outputs stay zero, as they were handed over.
            let row = c[o * v2 * order..][..v2 * order].iter_mut();
            row.zip(&self.state.x2).for_each(|(c, x)| *c = *x);
        }
    }

    /// Derivatives of sigma(k), kept for the next r outputs.
    #[inline(always)]
    fn remember(&mut self, k: usize, u: &[f64], inputs: usize, order: usize) {
        let FirstLayer { drive, activation, sigma, x1 } = self.sweep.at(k);
        let weights = &self.weights;
        let (own, span) = (inputs + 2 * order + 3, 2 * order - 1);
        self.d_sigma.rotate_right(1);
        self.fed.rotate_right(1);
        let fed = self.fed[0].iter_mut().zip(sigma.iter().chain(u));
        fed.for_each(|(fed, value)| *fed = *value);
        for i in 0..sigma.len() {
            let d_sigma = &mut self.d_sigma[0][i * own..][..own];
            let (a, b) = (&weights.a[i * order..][..order], &weights.b[i * order..][..order]);
            let xi = &x1[i * order..][..order];
            let sigma = sigma[i];
            let slope = 1.0 - sigma * sigma;
            let gain = slope * weights.g_2[i];
            let (to_w, rest) = d_sigma.split_at_mut(inputs);
            let (to_theta, rest) = rest.split_at_mut(order);
            let (to_b, last) = rest.split_at_mut(order);
            for (j, (to_w, u)) in to_w.iter_mut().zip(u).enumerate() {
                let eta = &mut self.eta[(i * inputs + j) * order..][..order];
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
            last[0] = gain * drive[i];
            last[1] = -gain;
            last[2] = slope * activation[i];
        }
    }
}

/// slice = terms, or slice += terms.
#[inline]
fn put(slice: &mut [f64], terms: impl Iterator<Item = f64>, add: bool) {
    if add {
        slice.iter_mut().zip(terms).for_each(|(s, term)| *s += term);
    } else {
        slice.iter_mut().zip(terms).for_each(|(s, term)| *s = term);
    }
}

impl Theta {
    /// Outputs over standardised inputs (row after row): one row of outputs a sample.
    pub fn simulate(&self, inputs: &[f64]) -> Vec<f64> {
        let weights = Weights::of_layers(Layers::of(self.structure, &self.values));
        let samples = inputs.len() / self.structure.inputs;
        let mut outputs = Vec::with_capacity(samples * self.structure.outputs);
        simulate(&weights, inputs, |y| outputs.extend_from_slice(y));
        outputs
    }

    /// Derivatives of the same outputs: parameters x (samples x outputs).
    pub fn jacobian(&self, inputs: &[f64]) -> DMatrix<f64> {
        let Structure { inputs: n, outputs: m, .. } = self.structure;
        let (p, samples) = (self.structure.parameters(), inputs.len() / n);
        let mut columns = vec![0.0; p * m * samples];
        let mut tangent = Tangent::new(self.structure, &self.values);
        let blocks = inputs.chunks(SWEEP * n).zip(columns.chunks_mut(SWEEP * p * m));
        for (rows, columns) in blocks {
            tangent.run(rows, columns, |_| ());
        }
        DMatrix::from_vec(p, m * samples, columns)
    }
}

/// Standardised inputs and measured outputs, row after row, of which the first `run_up` rows only
/// settle the state.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub(super) inputs: &'a [f64],
    pub(super) outputs: &'a [f64],
    pub(super) run_up: usize,
}

/// Sum of squared free-run errors.
pub(super) fn sse(structure: Structure, values: &[f64], rows: Rows) -> f64 {
    let weights = Weights::of_layers(Layers::of(structure, values));
    let mut measured = rows.outputs.chunks_exact(structure.outputs).enumerate();
    let mut sum = 0.0;
    simulate(&weights, rows.inputs, |y| {
        if let Some((_, measured)) = measured.next().filter(|(k, _)| *k >= rows.run_up) {
            sum += y.iter().zip(measured).map(|(y, m)| (y - m) * (y - m)).sum::<f64>();
        }
    });
    sum
}

/// The same with J^T J and J^T r, gathered sweep by sweep.
pub(super) fn linearise(structure: Structure, values: &[f64], rows: Rows) -> Linearisation {
    let (p, m) = (values.len(), structure.outputs);
    let mut gathered = Linearisation::new(p);
    let mut tangent = Tangent::new(structure, values);
    let mut columns = vec![0.0; p * m * SWEEP];
    let mut errors = Vec::with_capacity(m * SWEEP);
    let blocks = rows.inputs.chunks(SWEEP * structure.inputs);
    for (block, (inputs, outputs)) in blocks.zip(rows.outputs.chunks(SWEEP * m)).enumerate() {
        errors.clear();
        let mut measured = outputs.chunks_exact(m);
        tangent.run(inputs, &mut columns, |y| {
            if let Some(measured) = measured.next() {
                errors.extend(y.iter().zip(measured).map(|(y, m)| y - m));
            }
        });
        let settling = m * rows.run_up.saturating_sub(block * SWEEP).min(errors.len() / m);
        let counted = &columns[p * settling..p * errors.len()];
        let sensitivities = DMatrix::from_column_slice(p, errors.len() - settling, counted);
        gathered.add(&sensitivities, &errors[settling..]);
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
            Structure { inputs: 2, outputs: 2, v1: 2, v2: 3, order: 3, memory: Some(50) },
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
        let samples = 2 * SWEEP + 10;
        let (inputs, measured) = (noise(samples, 5), noise(2 * samples, 6));
        let rows = Rows { inputs: &inputs, outputs: &measured, run_up };
        let gathered = linearise(structure, &theta.values, rows);
        let jacobian =
            theta.jacobian(&inputs).columns(2 * run_up, 2 * (samples - run_up)).into_owned();
        let residuals: Vec<f64> =
            theta.simulate(&inputs).iter().zip(&measured).map(|(y, m)| y - m).collect();
        let mut whole = Linearisation::new(theta.values.len());
        whole.add(&jacobian, &residuals[2 * run_up..]);
        let scale = whole.normal_matrix.norm();
        assert!((&gathered.normal_matrix - &whole.normal_matrix).norm() < 1e-12 * scale);
        assert!((&gathered.gradient - &whole.gradient).norm() < 1e-12 * whole.gradient.norm());
        assert!((gathered.sse / whole.sse - 1.0).abs() < 1e-12);
        let plain = sse(structure, &theta.values, rows);
        assert!((plain / whole.sse - 1.0).abs() < 1e-12);
    }
}
