//! The models of the diagnoser: how large, how good.

use serde::{Deserialize, Serialize};

/// The process model and its error model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelSummary {
    /// What it is, in words.
    pub process_model: String,
    /// Samples it was trained on.
    pub training_samples: usize,
    /// Standard deviation of its free-run error on the training run, unit of T.
    pub training_sd: f64,
    /// Standard deviation of its residual on healthy closed-loop design data, unit of T.
    pub residual_sd: f64,
    /// Mean of that residual, unit of T.
    pub residual_mean: f64,
    /// Past outputs of the error model.
    pub n_a: usize,
    /// Past inputs of the error model.
    pub n_b: usize,
    /// Sum of squared one-step errors of the error model over the test samples, errors as shares of
    /// the set point.
    pub error_model_sse: f64,
    /// Samples of that sum.
    pub error_model_samples: usize,
    /// v of (6), (7): standard deviation of r - y_e on healthy data, unit of T.
    pub v: f64,
    /// p value of the whiteness test on r - y_e.
    pub whiteness_p: f64,
    /// p value of the normality test on r - y_e.
    pub normality_p: f64,
    /// Samples that v and the constant thresholds were measured on.
    pub design_samples: usize,
    /// Constant thresholds, unit of T.
    pub constant: (f64, f64),
    /// The recurrent error model.
    pub recurrent_error: Option<RecurrentErrorSummary>,
    /// The GMDH network.
    pub gmdh: Option<GmdhSummary>,
}

/// The recurrent error model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecurrentErrorSummary {
    /// IIR neurons.
    pub v1: usize,
    /// FIR neurons.
    pub v2: usize,
    /// Order of their filters.
    pub order: usize,
    /// v of (6), (7), unit of T.
    pub v: f64,
    /// p value of the whiteness test on r - y_e.
    pub whiteness_p: f64,
    /// p value of the normality test on r - y_e.
    pub normality_p: f64,
}

/// The GMDH network and the bounds of its parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GmdhSummary {
    /// Validation error of the best neuron of every layer tried, root mean square, unit of T.
    pub layers: Vec<f64>,
    /// Layers kept.
    pub kept: usize,
    /// Neurons left after pruning.
    pub neurons: usize,
    /// Validation error after all were trained together, unit of T.
    pub validation: f64,
    /// epsilon^m and epsilon^M (10) of the runs that are watched, unit of T.
    pub noise: [f64; 2],
    /// Vertices of the parameter set of the output neuron.
    pub vertices: usize,
}

/// One structure of the process model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StructureSummary {
    /// IIR neurons.
    pub v1: usize,
    /// FIR neurons.
    pub v2: usize,
    /// Order of their filters.
    pub order: usize,
    /// Parameters as written.
    pub parameters: usize,
    /// Parameters that the behaviour depends on: K.
    pub effective_parameters: usize,
    /// N ln(SSE / N) + 2 K on estimation data.
    pub aic: f64,
    /// Free-run error on validation data, root mean square, unit of T.
    pub validation: f64,
    /// Standard deviation of its residual on a healthy run of the closed loop that it was not fitted
    /// on, unit of T.
    pub healthy: f64,
    /// Whether it is the paper's.
    pub paper: bool,
    /// Whether it has the smallest AIC.
    pub best: bool,
    /// Whether the study runs with it: the smallest AIC among those that `healthy` does not tell apart.
    pub used: bool,
}

/// Theorem 1 on an example: z(k+1) = tanh(0.6 z(k) + 0.8 u(k)), inputs that no network was trained on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TheoremSummary {
    /// The error that was to be reached.
    pub epsilon: f64,
    /// Samples I over which the greatest error is taken.
    pub horizon: usize,
    /// Networks, the larger the later.
    pub rows: Vec<TheoremRow>,
}

/// A network in place of the example.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TheoremRow {
    /// IIR neurons.
    pub v1: usize,
    /// FIR neurons.
    pub v2: usize,
    /// Order of their filters.
    pub order: usize,
    /// Greatest error over the horizon and all test inputs.
    pub max_error: f64,
}
