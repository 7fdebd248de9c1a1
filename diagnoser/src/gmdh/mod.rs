//! The GMDH network of Section 2.3: layers of dynamic neurons with two inputs each,
//!
//! q(k) = -a_1 q(k-1) - .. + sum_j [b_j0 s_j(k) + .. + b_jnb s_j(k-nb)] + c,   s = xi(q(k)),
//!
//! an IIR filter of both inputs s_1, s_2 followed by an invertible activation. The first layer's
//! inputs are delayed input signals; a later layer's are outputs of neurons before it. Every
//! neuron imitates the system's output. With the regressor
//! r(k) = [-q(k-1).., s_1(k).., s_2(k).., 1] and p = [a.., b_1.., b_2.., c] it is xi(r^T p), as
//! (8) and (17) have it.
//!
//! ```text
//!  synthesis: layers, couples, selection, pruning, retraining  ──> Gmdh ──> GmdhRun (free run)
//!  bounds:    (8)-(10), (13)-(15), (17), (18) ──> parameter sets ──> RobustGmdh
//!  running:   (12), (16), (19) ──> GmdhBands, a threshold like any other
//! ```
//!
//! The network runs free: its filters remember their own states and no measured output, so that a
//! fault cannot leak in. Signals are standardised; the output is scaled into (-1, 1), where the
//! inverse of tanh exists.

mod activation;
mod bands;
mod bound_options;
mod bounds;
mod design;
mod fit;
mod layer;
mod options;
mod recurrent;
mod robust;
mod run;
mod series;
mod synthesis;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use self::activation::Activation;
pub use self::bands::GmdhBands;
pub use self::bound_options::{BoundOptions, Orthants, RobustError, Uncertain};
pub use self::bounds::{BoundError, ParameterSet, Part, Regressor};
pub use self::options::{GmdhError, GmdhOptions, GmdhReport, LayerRow};
pub use self::recurrent::{LocallyRecurrent, RecurrentLayer};
pub use self::robust::{NeuronBounds, RobustGmdh};
pub use self::run::GmdhRun;
use crate::scale::Scale;
use crate::stability::step_down;

/// What a neuron is fed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Source {
    /// An input signal.
    Input {
        input: usize,
        /// Samples that it is delayed by.
        delay: usize,
    },
    /// Output of a neuron that stands before this one.
    Neuron(usize),
}

/// A dynamic neuron with two inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GmdhNeuron {
    /// Layer it was made in, from 1.
    pub layer: usize,
    /// s_1 and s_2.
    pub sources: [Source; 2],
    /// xi.
    pub activation: Activation,
    /// a_1 .. a_na.
    pub a: Vec<f64>,
    /// b_j0 .. b_jnb for both inputs.
    pub b: [Vec<f64>; 2],
    /// c.
    pub constant: f64,
}

impl GmdhNeuron {
    /// p, in the order of the regressor.
    pub fn parameters(&self) -> Vec<f64> {
        let [b_1, b_2] = &self.b;
        self.a.iter().chain(b_1).chain(b_2).chain([&self.constant]).copied().collect()
    }

    fn orders(&self) -> Option<NeuronOrders> {
        let taps = self.b[0].len();
        (taps > 0 && self.b[1].len() == taps)
            .then(|| NeuronOrders { n_a: self.a.len(), n_b: taps - 1 })
    }
}

/// Orders of a neuron's filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NeuronOrders {
    /// Past filter outputs.
    pub n_a: usize,
    /// Past samples of either input, beside the present one.
    pub n_b: usize,
}

impl NeuronOrders {
    /// Entries of p: six for n_a = n_b = 1.
    pub fn parameters(self) -> usize {
        self.n_a + 2 * (self.n_b + 1) + 1
    }

    /// Where the delays of input j stand in p.
    fn taps(self, j: usize) -> std::ops::Range<usize> {
        let first = self.n_a + j * (self.n_b + 1);
        first..first + self.n_b + 1
    }
}

/// A synthesised network, in the form it is stored in; the last neuron is the output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gmdh {
    /// How each input is standardised.
    pub input_scales: Vec<Scale>,
    /// How the output is restored; its values then lie within (-1, 1).
    pub output_scale: Scale,
    /// Every neuron after those that feed it.
    pub neurons: Vec<GmdhNeuron>,
}

impl Gmdh {
    /// Orders of its neurons, or `None` if its parts do not fit together.
    pub fn orders(&self) -> Option<NeuronOrders> {
        let orders = self.neurons.first()?.orders();
        let fits = self.neurons.iter().enumerate().all(|(n, neuron)| {
            neuron.orders() == orders
                && neuron.sources.iter().all(|source| match source {
                    Source::Input { input, .. } => *input < self.input_scales.len(),
                    Source::Neuron(fed_by) => *fed_by < n,
                })
        });
        if fits { orders } else { None }
    }

    /// Whether a free run stays bounded: every filter stable, every number finite.
    pub fn is_stable(&self) -> bool {
        let stable = |neuron: &GmdhNeuron| {
            step_down(&neuron.a).is_some() && neuron.parameters().iter().all(|p| p.is_finite())
        };
        let mut scales = self.input_scales.iter().chain([&self.output_scale]);
        self.neurons.iter().all(stable) && scales.all(Scale::is_usable)
    }

    /// A free run from rest.
    ///
    /// # Panics
    /// If the parts do not fit together ([`Gmdh::orders`] is `None`).
    pub fn run(self: &Arc<Self>) -> GmdhRun {
        GmdhRun::new(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_that_do_not_fit_are_seen() {
        let neuron = GmdhNeuron {
            layer: 1,
            sources: [Source::Input { input: 0, delay: 1 }, Source::Input { input: 0, delay: 3 }],
            activation: Activation::Tanh,
            a: vec![-0.5],
            b: [vec![1.0, 0.0], vec![0.5, 0.5]],
            constant: 0.1,
        };
        let scale = Scale { mean: 0.0, deviation: 1.0 };
        let good =
            Gmdh { input_scales: vec![scale], output_scale: scale, neurons: vec![neuron.clone()] };
        assert_eq!(good.orders(), Some(NeuronOrders { n_a: 1, n_b: 1 }));
        assert_eq!(neuron.parameters(), [-0.5, 1.0, 0.0, 0.5, 0.5, 0.1]);
        assert!(good.is_stable());
        let mut ahead = good.clone();
        ahead.neurons[0].sources[0] = Source::Neuron(0);
        assert_eq!(ahead.orders(), None);
        let mut missing = good.clone();
        missing.neurons[0].sources[0] = Source::Input { input: 1, delay: 0 };
        assert_eq!(missing.orders(), None);
        let mut short = good.clone();
        short.neurons[0].b[1].pop();
        assert_eq!(short.orders(), None);
        let mut unstable = good;
        unstable.neurons[0].a[0] = -1.01;
        assert!(!unstable.is_stable());
    }
}
