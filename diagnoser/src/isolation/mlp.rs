//! A multilayer perceptron with two hidden layers: tanh, tanh, sigmoid.
//!
//! h_1 = tanh(W_1 x~), h_2 = tanh(W_2 h_1~), y = 1 / (1 + exp(-W_3 h_2~)), where ~ appends a 1.

use drivescope_numerics::elementary::{exp, tanh};
use serde::{Deserialize, Serialize};

/// Neurons of a perceptron: inputs, two hidden layers, outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MlpSize {
    pub inputs: usize,
    /// Neurons of the two hidden layers.
    pub hidden: [usize; 2],
    pub outputs: usize,
}

impl MlpSize {
    /// Weights and biases.
    pub fn parameters(self) -> usize {
        let [first, second] = self.hidden;
        first * (self.inputs + 1) + second * (first + 1) + self.outputs * (second + 1)
    }
}

/// A perceptron; W_1, W_2, W_3 row by row, the bias last in each row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mlp {
    pub size: MlpSize,
    /// [`MlpSize::parameters`] values.
    pub weights: Vec<f64>,
}

/// What every layer shows for one input, each with a 1 at its end but the last.
#[derive(Debug, Clone)]
pub(super) struct Layers {
    pub(super) x: Vec<f64>,
    pub(super) h_1: Vec<f64>,
    pub(super) h_2: Vec<f64>,
    pub(super) y: Vec<f64>,
}

impl Layers {
    pub(super) fn new(size: MlpSize) -> Self {
        let [first, second] = size.hidden;
        let room = |neurons: usize| vec![1.0; neurons + 1];
        Self {
            x: room(size.inputs),
            h_1: room(first),
            h_2: room(second),
            y: vec![0.0; size.outputs],
        }
    }

    /// One pass forward.
    pub(super) fn run(&mut self, size: MlpSize, weights: &[f64], x: &[f64]) {
        let (w_1, w_2, w_3) = matrices(size, weights);
        self.x[..size.inputs].copy_from_slice(x);
        let layer = |weights: &[f64], from: &[f64], to: &mut [f64], xi: fn(f64) -> f64| {
            for (to, row) in to.iter_mut().zip(weights.chunks_exact(from.len())) {
                *to = xi(row.iter().zip(from).map(|(w, h)| w * h).sum());
            }
        };
        let [first, second] = size.hidden;
        layer(w_1, &self.x, &mut self.h_1[..first], tanh);
        layer(w_2, &self.h_1, &mut self.h_2[..second], tanh);
        layer(w_3, &self.h_2, &mut self.y, |z| 1.0 / (1.0 + exp(-z)));
    }
}

/// W_1, W_2, W_3.
pub(super) fn matrices(size: MlpSize, weights: &[f64]) -> (&[f64], &[f64], &[f64]) {
    let [first, second] = size.hidden;
    let (w_1, rest) = weights.split_at(first * (size.inputs + 1));
    let (w_2, w_3) = rest.split_at(second * (first + 1));
    (w_1, w_2, w_3)
}

impl Mlp {
    /// A random start: weights of variance 1 / fan-in, biases of half that size.
    pub(super) fn draw(size: MlpSize, mut normal: impl FnMut() -> f64) -> Vec<f64> {
        let [first, second] = size.hidden;
        let layers = [(size.inputs, first), (first, second), (second, size.outputs)];
        let mut weights = Vec::with_capacity(size.parameters());
        for (from, to) in layers {
            let spread = 1.0 / (from as f64).sqrt();
            for _ in 0..to {
                weights.extend((0..from).map(|_| spread * normal()));
                weights.push(0.5 * normal());
            }
        }
        weights
    }

    /// Outputs within (0, 1).
    ///
    /// # Panics
    /// If there are not as many inputs or weights as [`Mlp::size`] says.
    pub fn outputs(&self, x: &[f64]) -> Vec<f64> {
        let mut layers = Layers::new(self.size);
        layers.run(self.size, &self.weights, x);
        layers.y
    }
}
