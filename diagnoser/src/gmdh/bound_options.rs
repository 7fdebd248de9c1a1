//! How the parameters of a GMDH network are bounded, and why that may be refused.

use thiserror::Error;

use super::BoundError;
use crate::data::DataError;

/// Whose parameters are bounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uncertain {
    /// Those of the output neuron; what feeds it is taken as exact.
    OutputNeuron,
    /// Those of every neuron; intervals pass from layer to layer.
    EveryNeuron,
}

/// Where parameters with uncertain regressors are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Orthants {
    /// In the orthant of the least-squares estimate; intervals are conditional on it.
    OfEstimate,
    /// In all orthants: exact, 2^m parts for m uncertain regressors.
    All,
}

/// How parameters are bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundOptions {
    /// Noise bounds as a multiple of the smallest possible ones; at least 1.
    pub inflation: f64,
    /// Noise bounds epsilon^m, epsilon^M of the output, in its unit, if they are known.
    pub given: Option<[f64; 2]>,
    /// Whose parameters are bounded.
    pub uncertain: Uncertain,
    /// Where they are looked for.
    pub orthants: Orthants,
    /// Samples at the start of every recording of the watched kind that only settle the filters.
    pub run_up: usize,
    /// The same of excited recordings, whose bounds are wider.
    pub excited_run_up: usize,
}

impl Default for BoundOptions {
    fn default() -> Self {
        Self {
            inflation: 1.1,
            given: None,
            uncertain: Uncertain::OutputNeuron,
            orthants: Orthants::OfEstimate,
            run_up: 500,
            excited_run_up: 300,
        }
    }
}

/// Why the parameters of a network cannot be bounded.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RobustError {
    /// No design data.
    #[error("bounds need at least one healthy recording")]
    NoRecording,
    /// The parts of the network do not fit together, or not the data, or a filter is unstable.
    #[error(
        "the network does not fit recording {recording} of {inputs} inputs, or is unstable: synthesise it again"
    )]
    Network {
        /// Design recording, from 0.
        recording: usize,
        inputs: usize,
    },
    /// The healthy data do not serve.
    #[error("design recording {recording}: {source}")]
    Data {
        /// Design recording, from 0.
        recording: usize,
        /// What is wrong with it.
        source: DataError,
    },
    /// An inflation below one leaves no parameters.
    #[error(
        "noise bounds {inflation} times the smallest possible ones leave no parameters: give at least 1"
    )]
    Inflation {
        /// The value given.
        inflation: f64,
    },
    /// Given noise bounds that do not enclose anything.
    #[error("noise bounds must be finite and {lower} below {upper}")]
    Noise {
        /// epsilon^m.
        lower: f64,
        /// epsilon^M.
        upper: f64,
    },
    /// A neuron has no bounded parameter set.
    #[error("neuron {neuron}: {source}")]
    Neuron {
        /// Which one, from 0.
        neuron: usize,
        /// Why.
        source: BoundError,
    },
}
