//! The network in free run, sample by sample, in the units of its signals.

use std::sync::Arc;

use super::Network;
use super::layers::{State, Sweep, Weights};
use crate::memory::{Memory, MemoryError, Walk};
use crate::signal_model::SignalModel;

/// A network in free run, in the units of its signals.
#[derive(Debug, Clone)]
pub struct NetworkRun {
    network: Arc<Network>,
    weights: Arc<Weights>,
    state: State,
    sweep: Sweep,
    input: Vec<f64>,
    output: Vec<f64>,
}

impl NetworkRun {
    pub(super) fn new(network: &Arc<Network>) -> Self {
        let structure = network.structure().expect("parts that fit together: checked on loading");
        Self {
            network: Arc::clone(network),
            weights: Arc::new(Weights::of_network(network, structure)),
            state: State::at_rest(structure),
            sweep: Sweep::new(structure, 1),
            input: vec![0.0; structure.inputs],
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
        for ((input, u), scale) in self.input.iter_mut().zip(u).zip(scales) {
            *input = scale.standardise(*u);
        }
        self.sweep.run(&mut self.state, &self.weights, &self.input);
        self.state.feed(&self.weights, self.sweep.at(0).sigma, &self.input);
        let scales = self.network.output_scales.iter();
        for ((output, y), scale) in self.output.iter_mut().zip(&self.state.y).zip(scales) {
            *output = scale.restore(*y);
        }
        &self.output
    }
}

impl Memory for NetworkRun {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        let State { x1, x2, y } = &mut self.state;
        walk.each([x1, x2, y].into_iter().flatten())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;
    use crate::network::Structure;
    use crate::network::Theta;
    use crate::network::layers::SWEEP;
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
        let structure =
            Structure { inputs: 2, outputs: 2, v1: 2, v2: 3, order: 2, ..Structure::PAPER };
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
    fn a_sweep_equals_the_stream_bit_for_bit() {
        let structure =
            Structure { inputs: 2, outputs: 2, v1: 3, v2: 2, order: 2, ..Structure::PAPER };
        let mut draws = noise(1000, 9).into_iter();
        let theta = Theta::draw(structure, || draws.next().unwrap());
        let unit = Scale { mean: 0.0, deviation: 1.0 };
        let network = Arc::new(theta.network(vec![unit; 2], vec![unit; 2]));
        let inputs = noise(2 * (2 * SWEEP + 7), 10);
        let mut run = network.run();
        let stream: Vec<f64> = inputs.chunks_exact(2).flat_map(|u| run.step(u).to_vec()).collect();
        assert_eq!(theta.simulate(&inputs), stream);
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
