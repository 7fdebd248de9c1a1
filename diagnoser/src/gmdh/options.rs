//! How a GMDH network is synthesised, what is reported of it, and why it may be refused.

use drivescope_numerics::Limits;
use thiserror::Error;

use super::NeuronOrders;
use crate::data::DataError;

/// How a network is synthesised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GmdhOptions {
    /// Orders of every neuron's filter.
    pub orders: NeuronOrders,
    /// Smallest delay of an input: 1 unless the inputs were delayed before.
    pub first_delay: usize,
    /// Delays of every input that form the first layer's input vector, n_b + 1 apart.
    pub delays: usize,
    /// Neurons of a layer that feed the next one.
    pub survivors: usize,
    /// Share by which a layer must lower the best validation error (root mean square) to be kept.
    pub least_gain: f64,
    /// Layers at most.
    pub most_layers: usize,
    /// Longest memory of a filter, samples: its reflection coefficients stay below 1 - 1 / memory. A
    /// slower one would fit the drift of a short recording and leave the data of a longer one.
    pub memory: f64,
    /// Samples at the start of every recording that only settle the filters.
    pub run_up: usize,
    /// When the fit of one neuron stops.
    pub neuron: Limits,
    /// When the retraining of the whole network stops; 0 steps for none.
    pub retraining: Limits,
}

impl Default for GmdhOptions {
    fn default() -> Self {
        Self {
            orders: NeuronOrders { n_a: 1, n_b: 1 },
            first_delay: 1,
            delays: 4,
            survivors: 5,
            least_gain: 1e-2,
            most_layers: 8,
            memory: 250.0,
            run_up: 100,
            neuron: Limits { steps: 30, relative_decrease: 1e-5 },
            retraining: Limits { steps: 60, relative_decrease: 1e-6 },
        }
    }
}

/// Why a network cannot be synthesised.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GmdhError {
    /// The signals do not serve.
    #[error("GMDH synthesis, {set} recording {recording}: {source}")]
    Data {
        /// Which data set.
        set: &'static str,
        /// Which recording of it, from 0.
        recording: usize,
        /// What is wrong with it.
        source: DataError,
    },
    /// No recording was given.
    #[error("GMDH synthesis needs at least one {set} recording")]
    NoRecording {
        /// Which data set.
        set: &'static str,
    },
    /// Another number of inputs than in the first recording.
    #[error("GMDH synthesis, {set} recording {recording} has {found} inputs, the first {expected}")]
    Inputs {
        /// Which data set.
        set: &'static str,
        /// Which recording of it, from 0.
        recording: usize,
        /// Inputs of the first recording.
        expected: usize,
        /// Inputs found.
        found: usize,
    },
    /// Not even one couple of variables.
    #[error(
        "{inputs} inputs with {delays} delays each give no couple of variables: ask for more delays"
    )]
    NoCouple {
        /// Inputs of the data.
        inputs: usize,
        delays: usize,
    },
    /// No neuron of the first layer could be fitted.
    #[error(
        "none of the {candidates} neurons of the first layer has a stable fit: give more data or lower the orders"
    )]
    NoNeuron {
        /// Neurons tried.
        candidates: usize,
    },
}

/// What a layer brought.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerRow {
    /// The layer, from 1.
    pub layer: usize,
    /// Neurons tried.
    pub candidates: usize,
    /// Smallest root mean square free-run error on validation data, output unit.
    pub validation: f64,
}

/// What the synthesis found on the way; errors are root mean squares in free run, output unit.
#[derive(Debug, Clone, PartialEq)]
pub struct GmdhReport {
    /// All layers tried; the last may be one that did not gain enough.
    pub layers: Vec<LayerRow>,
    /// Layers kept.
    pub kept: usize,
    /// Validation error before the whole was retrained.
    pub before_retraining: f64,
    /// Validation error of the network returned.
    pub validation: f64,
    /// Estimation error of the network returned.
    pub estimation: f64,
}
