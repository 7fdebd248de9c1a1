//! The network in free run, sample by sample.

use std::sync::Arc;

use drivescope_numerics::elementary::tanh;

use super::theta::Layers;
use super::{Network, Structure};
use crate::signal_model::SignalModel;

/// The numbers of a network side by side, for standardised signals.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    pub(super) structure: Structure,
    pub(super) w: Vec<f64>,
    pub(super) a: Vec<f64>,
    pub(super) b: Vec<f64>,
    pub(super) b_0: Vec<f64>,
    pub(super) g_1: Vec<f64>,
    pub(super) g_2: Vec<f64>,
    /// v2 rows of v1 + n: [W2 | Wu].
    pub(super) fir: Vec<f64>,
    pub(super) c: Vec<f64>,
}

impl Weights {
    pub(super) fn of_layers(layers: Layers) -> Self {
        let mut weights = Self::empty(layers.structure);
        for neuron in layers.neurons() {
            weights.push(neuron.w, &neuron.denominator(), neuron.b);
            weights.b_0.push(neuron.b_0);
            weights.g_1.push(neuron.g_1);
            weights.g_2.push(neuron.g_2);
        }
        weights.fir = layers.fir.to_vec();
        weights.c = layers.c.to_vec();
        weights
    }

    fn of_network(network: &Network, structure: Structure) -> Self {
        let mut weights = Self::empty(structure);
        for neuron in &network.iir {
            weights.push(&neuron.w, &neuron.a, &neuron.b);
            weights.b_0.push(neuron.b_0);
            weights.g_1.push(neuron.g_1);
            weights.g_2.push(neuron.g_2);
        }
        weights.fir =
            network.fir.iter().flat_map(|row| row.w_2.iter().chain(&row.w_u)).copied().collect();
        weights.c = network.c.concat();
        weights
    }

    fn empty(structure: Structure) -> Self {
        let none = Vec::new;
        Self {
            structure,
            w: none(),
            a: none(),
            b: none(),
            b_0: none(),
            g_1: none(),
            g_2: none(),
            fir: none(),
            c: none(),
        }
    }

    fn push(&mut self, w: &[f64], a: &[f64], b: &[f64]) {
        self.w.extend_from_slice(w);
        self.a.extend_from_slice(a);
        self.b.extend_from_slice(b);
    }
}

/// State of a run over standardised signals, and what the last step computed on its way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    /// x1: per IIR neuron its filter's last r values, newest first.
    pub(super) x1: Vec<f64>,
    /// x2: per FIR neuron its last r values, newest first.
    pub(super) x2: Vec<f64>,
    /// [sigma; u] of the last step.
    pub(super) fed: Vec<f64>,
    /// B1 x1 + D1 u - g1 of the last step, per IIR neuron.
    pub(super) activation: Vec<f64>,
    /// W1 u of the last step, per IIR neuron.
    pub(super) drive: Vec<f64>,
    /// y, standardised.
    pub(super) y: Vec<f64>,
}

impl State {
    pub(super) fn at_rest(structure: Structure) -> Self {
        let Structure { inputs, outputs, v1, v2, order } = structure;
        Self {
            x1: vec![0.0; v1 * order],
            x2: vec![0.0; v2 * order],
            fed: vec![0.0; v1 + inputs],
            activation: vec![0.0; v1],
            drive: vec![0.0; v1],
            y: vec![0.0; outputs],
        }
    }

    /// y of this sample by (5), then the states of the next by (1).
    #[inline]
    pub(super) fn step(&mut self, weights: &Weights, u: impl IntoIterator<Item = f64>) {
        let Structure { inputs, v1, order, .. } = weights.structure;
        for (y, row) in self.y.iter_mut().zip(weights.c.chunks_exact(self.x2.len())) {
            *y = sum_of_products(row, &self.x2);
        }
        for (fed, u) in self.fed[v1..].iter_mut().zip(u) {
            *fed = u;
        }
        let u = &self.fed[v1..];
        let filters = self.x1.chunks_exact_mut(order).zip(weights.a.chunks_exact(order));
        let inputs_of = weights.w.chunks_exact(inputs).zip(weights.b.chunks_exact(order));
        for (i, ((x, a), (w, b))) in filters.zip(inputs_of).enumerate() {
            let drive = sum_of_products(w, u);
            let activation = weights.b_0[i] * drive + sum_of_products(b, x) - weights.g_1[i];
            let next = drive - sum_of_products(a, x);
            shift_in(x, next);
            self.drive[i] = drive;
            self.activation[i] = activation;
        }
        for i in 0..v1 {
            self.fed[i] = tanh(weights.g_2[i] * self.activation[i]);
        }
        let rows = weights.fir.chunks_exact(v1 + inputs);
        for (x, row) in self.x2.chunks_exact_mut(order).zip(rows) {
            shift_in(x, sum_of_products(row, &self.fed));
        }
    }
}

#[inline]
pub(super) fn shift_in(delays: &mut [f64], newest: f64) {
    for l in (1..delays.len()).rev() {
        delays[l] = delays[l - 1];
    }
    delays[0] = newest;
}

#[inline]
pub(super) fn sum_of_products(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A network in free run, in the units of its signals.
#[derive(Debug, Clone)]
pub struct NetworkRun {
    network: Arc<Network>,
    weights: Arc<Weights>,
    state: State,
    output: Vec<f64>,
}

impl NetworkRun {
    pub(super) fn new(network: &Arc<Network>) -> Self {
        let structure = network.structure().expect("parts that fit together: checked on loading");
        Self {
            network: Arc::clone(network),
            weights: Arc::new(Weights::of_network(network, structure)),
            state: State::at_rest(structure),
            output: vec![0.0; structure.outputs],
        }
    }
}

impl SignalModel for NetworkRun {
    fn inputs(&self) -> usize {
        self.weights.structure.inputs
    }

    fn outputs(&self) -> usize {
        self.weights.structure.outputs
    }

    fn reset(&mut self) {
        self.state = State::at_rest(self.weights.structure);
    }

    #[inline]
    fn step(&mut self, u: &[f64]) -> &[f64] {
        let scales = self.network.input_scales.iter();
        self.state.step(&self.weights, u.iter().zip(scales).map(|(u, s)| s.standardise(*u)));
        let scales = self.network.output_scales.iter();
        for ((output, y), scale) in self.output.iter_mut().zip(&self.state.y).zip(scales) {
            *output = scale.restore(*y);
        }
        &self.output
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;
    use crate::network::Theta;
    use crate::scale::Scale;
    use crate::signal_model::free_run;
    use crate::testing::noise;

    /// Sums of a few dozen products in another order.
    const ROUNDING: f64 = 1e-12;

    fn network(structure: Structure, seed: u64) -> Arc<Network> {
        let mut draws = noise(1000, seed).into_iter();
        let theta = Theta::draw(structure, || draws.next().unwrap());
        let scale = |j| Scale { mean: 1.0 + j as f64, deviation: 2.0 };
        let scales = |count| (0..count).map(scale).collect();
        Arc::new(theta.network(scales(structure.inputs), scales(structure.outputs)))
    }

    #[test]
    fn first_order_fir_neurons_collapse_to_one_row() {
        let network = network(Structure::PAPER, 1);
        let u = noise(300, 2);
        let written = free_run(&mut network.run(), &[Column { name: "u", values: &u }]);
        // y(k+1) = sum_i (sum_j c_j w_2ji) sigma_i(k) + (sum_j c_j w_uj) u(k): two layers gone.
        let row = |i: usize| -> f64 {
            let weights = network.fir.iter().zip(&network.c[0]);
            weights.map(|(f, c)| c * if i < 3 { f.w_2[i] } else { f.w_u[0] }).sum()
        };
        let collapsed: Vec<f64> = (0..4).map(row).collect();
        let mut x = [0.0; 3];
        let mut next = 0.0;
        for (u, y) in u.iter().zip(&written[0]) {
            assert!((1.0 + 2.0 * next - y).abs() < ROUNDING);
            let u = (u - 1.0) / 2.0;
            next = collapsed[3] * u;
            for (i, neuron) in network.iir.iter().enumerate() {
                let s = neuron.w[0] * u;
                let q = neuron.g_2 * (neuron.b[0] * x[i] + neuron.b_0 * s - neuron.g_1);
                next += collapsed[i] * q.tanh();
                x[i] = s - neuron.a[0] * x[i];
            }
        }
    }

    #[test]
    fn matrices_of_higher_order_with_several_signals_give_the_same_outputs() {
        let structure = Structure { inputs: 2, outputs: 2, v1: 2, v2: 3, order: 2 };
        let network = network(structure, 3);
        let (u1, u2) = (noise(200, 4), noise(200, 5));
        let inputs = [("u1", &u1), ("u2", &u2)].map(|(name, values)| Column { name, values });
        let y = free_run(&mut network.run(), &inputs);
        // (1), (5) with the matrices themselves.
        let (mut x1, mut x2) = ([[0.0; 2]; 2], [[0.0; 2]; 3]);
        for k in 0..200 {
            for (o, (y, c)) in y.iter().zip(&network.c).enumerate() {
                let sum: f64 = (0..6).map(|s| c[s] * x2[s / 2][s % 2]).sum();
                let expected = 1.0 + o as f64 + 2.0 * sum;
                assert!((y[k] - expected).abs() < ROUNDING, "output {o} at {k}");
            }
            let u = [(u1[k] - 1.0) / 2.0, (u2[k] - 2.0) / 2.0];
            let mut sigma = [0.0; 2];
            for (i, neuron) in network.iir.iter().enumerate() {
                let s = neuron.w[0] * u[0] + neuron.w[1] * u[1];
                let x = x1[i];
                let sum = neuron.b[0] * x[0] + neuron.b[1] * x[1] + neuron.b_0 * s;
                sigma[i] = (neuron.g_2 * (sum - neuron.g_1)).tanh();
                x1[i] = [-neuron.a[0] * x[0] - neuron.a[1] * x[1] + s, x[0]];
            }
            for (j, neuron) in network.fir.iter().enumerate() {
                let fed = neuron.w_2[0] * sigma[0] + neuron.w_2[1] * sigma[1];
                let direct = neuron.w_u[0] * u[0] + neuron.w_u[1] * u[1];
                x2[j] = [fed + direct, x2[j][0]];
            }
        }
    }

    #[test]
    fn a_clone_replays_and_a_reset_starts_again() {
        let mut run = network(Structure::PAPER, 6).run();
        let u = noise(50, 7);
        let first: Vec<f64> = u.iter().map(|u| run.step(&[*u])[0]).collect();
        let mut copy = run.clone();
        let ahead: Vec<f64> = u.iter().map(|u| run.step(&[*u])[0]).collect();
        let replay: Vec<f64> = u.iter().map(|u| copy.step(&[*u])[0]).collect();
        assert_eq!(ahead, replay);
        copy.reset();
        let again: Vec<f64> = u.iter().map(|u| copy.step(&[*u])[0]).collect();
        assert_eq!(first, again);
    }

    #[test]
    fn an_unstable_filter_is_seen() {
        let mut broken = Network::clone(&network(Structure::PAPER, 8));
        assert!(broken.is_stable());
        broken.iir[1].a[0] = -1.0;
        assert!(!broken.is_stable());
        broken.fir.pop();
        assert_eq!(broken.structure(), None);
    }
}
