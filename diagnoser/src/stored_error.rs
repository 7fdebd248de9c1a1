//! An error model with its bands, as it is stored.

use serde::{Deserialize, Serialize};

use crate::model::{Model, ModelRun};
use crate::model_error::{BandDesign, ErrorBands};
use crate::threshold::Confidence;

/// The stored form of the bands (6), (7).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelError {
    /// v, the standard deviation of r - y_e on the design set, output unit.
    pub deviation: f64,
    /// Samples of the design set, run-up excluded.
    pub samples: usize,
    /// Standard deviation of r itself over the same samples, output unit; that of the constant
    /// thresholds in files that do not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plain: Option<f64>,
    /// Samples in which it settles, five of its slowest time constants.
    #[serde(default)]
    pub run_up: usize,
    /// Whether they outlast half of what it was designed on: it is not used then.
    #[serde(default)]
    pub outlasts: bool,
    /// The error model.
    pub model: Model,
}

impl ModelError {
    /// An error model whose r - y_e has mean zero on the data that its bands were designed on.
    pub(crate) fn centred(model: &Model, bands: &BandDesign, outlasts: bool) -> Self {
        let BandDesign { mean, deviation, samples, plain, .. } = *bands;
        let (run_up, model) = (model.run_up(), model.raised(mean));
        Self { deviation, samples, plain: Some(plain), run_up, outlasts, model }
    }

    /// The bands at their start.
    pub(crate) fn bands(&self, confidence: Confidence) -> ErrorBands<ModelRun> {
        ErrorBands::new(self.model.run(), self.deviation, confidence)
    }

    /// Samples in which it settles, if it is to be used.
    pub(crate) fn settles(&self) -> usize {
        if self.outlasts { 0 } else { self.run_up }
    }
}
