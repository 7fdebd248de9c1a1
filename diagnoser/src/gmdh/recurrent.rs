//! The same network as a locally recurrent one in state space (Section 2.4).
//!
//! Layer by layer x(k+1) = A x(k) + W s(k), q(k) = B x(k) + D s(k), s' = xi(q), with block diagonal
//! A and B: every neuron's IIR filter in observer form, of order max(n_a, n_b), A = [-a | shift],
//! W = b_i - a_i b_0, D = b_0. The first entry of s is the constant 1, whose weight is the bias.
//! This is the form (1a) of the first layer of the cascade network, with a numerator for every
//! input instead of a common one.

use nalgebra::{DMatrix, DVector};

use super::{Activation, Gmdh, Source};
use crate::data::Column;
use crate::scale::Scale;

/// One neuron layer in state space.
#[derive(Debug, Clone, PartialEq)]
pub struct RecurrentLayer {
    /// A, block diagonal.
    pub a: DMatrix<f64>,
    /// W, states x signals.
    pub w: DMatrix<f64>,
    /// B, block diagonal, neurons x states.
    pub b: DMatrix<f64>,
    /// D, neurons x signals.
    pub d: DMatrix<f64>,
    /// xi of every neuron.
    pub activations: Vec<Activation>,
}

/// A GMDH network written as a locally recurrent network with as many layers.
#[derive(Debug, Clone, PartialEq)]
pub struct LocallyRecurrent {
    /// Delayed inputs that the layers see after the constant, as (input, delay).
    pub inputs: Vec<(usize, usize)>,
    /// The layers; each sees the constant, the delayed inputs and the outputs of all layers before.
    pub layers: Vec<RecurrentLayer>,
    input_scales: Vec<Scale>,
    output_scale: Scale,
}

impl Gmdh {
    /// The equivalent locally recurrent network; `None` if the parts do not fit together or a
    /// neuron is fed by one of its own layer.
    pub fn locally_recurrent(&self) -> Option<LocallyRecurrent> {
        let orders = self.orders()?;
        let order = orders.n_a.max(orders.n_b);
        let mut inputs: Vec<(usize, usize)> = Vec::new();
        for source in self.neurons.iter().flat_map(|neuron| neuron.sources) {
            if let Source::Input { input, delay } = source
                && !inputs.contains(&(input, delay))
            {
                inputs.push((input, delay));
            }
        }
        let column = |source: &Source| match *source {
            Source::Input { input, delay } => {
                inputs.iter().position(|seen| *seen == (input, delay)).map(|place| 1 + place)
            }
            Source::Neuron(n) => Some(1 + inputs.len() + n),
        };
        let mut layers = Vec::new();
        let mut first = 0;
        for own in self.neurons.chunk_by(|a, b| a.layer == b.layer) {
            let signals = 1 + inputs.len() + first;
            let states = own.len() * order;
            let mut layer = RecurrentLayer {
                a: DMatrix::zeros(states, states),
                w: DMatrix::zeros(states, signals),
                b: DMatrix::zeros(own.len(), states),
                d: DMatrix::zeros(own.len(), signals),
                activations: own.iter().map(|neuron| neuron.activation).collect(),
            };
            for (row, neuron) in own.iter().enumerate() {
                let state = row * order;
                let a = |i: usize| neuron.a.get(i).copied().unwrap_or(0.0);
                for i in 0..order {
                    layer.a[(state + i, state)] = -a(i);
                    if i + 1 < order {
                        layer.a[(state + i, state + i + 1)] = 1.0;
                    }
                }
                if order > 0 {
                    layer.b[(row, state)] = 1.0;
                }
                let bias = [neuron.constant];
                let mut feeds = vec![(0, &bias[..])];
                for (source, b) in neuron.sources.iter().zip(&neuron.b) {
                    feeds.push((column(source).filter(|column| *column < signals)?, &b[..]));
                }
                for (column, b) in feeds {
                    layer.d[(row, column)] += b[0];
                    for i in 0..order {
                        let tap = b.get(i + 1).copied().unwrap_or(0.0);
                        layer.w[(state + i, column)] += tap - a(i) * b[0];
                    }
                }
            }
            first += own.len();
            layers.push(layer);
        }
        let (input_scales, output_scale) = (self.input_scales.clone(), self.output_scale);
        Some(LocallyRecurrent { inputs, layers, input_scales, output_scale })
    }
}

impl LocallyRecurrent {
    /// Free run from rest: the output in its unit, one value a sample.
    pub fn free_run(&self, inputs: &[Column]) -> Vec<f64> {
        let samples = inputs.first().map_or(0, |column| column.values.len());
        let at_rest = |layer: &RecurrentLayer| DVector::zeros(layer.a.nrows());
        let mut states: Vec<DVector<f64>> = self.layers.iter().map(at_rest).collect();
        let input = |k: usize, (input, delay): (usize, usize)| {
            let past = k.checked_sub(delay);
            past.map_or(0.0, |k| self.input_scales[input].standardise(inputs[input].values[k]))
        };
        (0..samples)
            .map(|k| {
                let mut signals = vec![1.0];
                signals.extend(self.inputs.iter().map(|place| input(k, *place)));
                for (layer, x) in self.layers.iter().zip(&mut states) {
                    let s = DVector::from_column_slice(&signals);
                    let q = &layer.b * &*x + &layer.d * &s;
                    *x = &layer.a * &*x + &layer.w * &s;
                    let outputs = q.iter().zip(&layer.activations);
                    signals.extend(outputs.map(|(q, activation)| activation.value(*q)));
                }
                self.output_scale.restore(signals[signals.len() - 1])
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Data;
    use crate::gmdh::{GmdhOptions, NeuronOrders};
    use crate::signal_model::free_run;
    use crate::testing::multisine;

    /// Sums of a dozen products in another order, remembered by filters of some hundred samples;
    /// relative to the largest output.
    const ROUNDING: f64 = 1e-10;

    #[test]
    fn a_retrained_network_is_a_locally_recurrent_one() {
        let runs = [multisine(400, 1), multisine(400, 2)];
        let data: Vec<Data> = runs
            .iter()
            .map(|run| {
                let input = Column { name: "C_m", values: &run.control };
                Data::new(vec![input], Column { name: "T", values: &run.speed }).unwrap()
            })
            .collect();
        for orders in [NeuronOrders { n_a: 1, n_b: 1 }, NeuronOrders { n_a: 2, n_b: 0 }] {
            let options = GmdhOptions { orders, delays: 3, survivors: 3, ..GmdhOptions::default() };
            let (network, report) = Gmdh::synthesise(&data[..1], &data[1..], &options).unwrap();
            assert!(report.validation <= report.before_retraining);
            let recurrent = network.locally_recurrent().unwrap();
            assert_eq!(recurrent.layers.len(), report.kept);
            let y = free_run(&mut network.run(), data[1].inputs()).swap_remove(0);
            let largest = y.iter().fold(0.0_f64, |largest, y| largest.max(y.abs()));
            for (k, (a, b)) in recurrent.free_run(data[1].inputs()).iter().zip(&y).enumerate() {
                assert!((a - b).abs() < ROUNDING * largest, "{a} and {b} at {k}");
            }
        }
    }
}
