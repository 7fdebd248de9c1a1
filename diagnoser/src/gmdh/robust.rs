//! A network whose parameters are known within bounds.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Gmdh;
use super::bounds::ParameterSet;

/// What is known of one neuron.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NeuronBounds {
    pub neuron: usize,
    /// epsilon^m and epsilon^M, standardised as the output is.
    pub noise: [f64; 2],
    /// Its feasible parameters.
    pub set: ParameterSet,
}

/// A GMDH network with bounded parameters, in the form it is stored in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobustGmdh {
    pub network: Arc<Gmdh>,
    /// Uncertain neurons, in the order of the network; the output neuron is one of them.
    pub bounds: Vec<NeuronBounds>,
}

impl RobustGmdh {
    /// Noise bounds epsilon^m, epsilon^M of the output, in its unit.
    pub fn noise(&self) -> Option<[f64; 2]> {
        let last = self.bounds.last()?;
        Some(last.noise.map(|epsilon| epsilon * self.network.output_scale.deviation))
    }

    /// Input signals, or `None` if the parts do not fit together.
    pub fn inputs(&self) -> Option<usize> {
        let parameters = self.network.orders()?.parameters();
        let output = self.network.neurons.len() - 1;
        let fits = self.bounds.last().is_some_and(|last| last.neuron == output)
            && self
                .bounds
                .iter()
                .all(|bounds| bounds.neuron <= output && bounds.set.centre.len() == parameters);
        fits.then_some(self.network.input_scales.len())
    }
}
