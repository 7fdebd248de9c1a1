//! Model error modelling, (6) and (7), with the ARX error model.

use serde::{Deserialize, Serialize};

use super::law::{Elsewhere, Info, Refusal, ResidualDetector};
use crate::detector::DetectorError;
use crate::diagnoser::Diagnoser;
use crate::flaw::Flaw;
use crate::model::{Model, ModelRun};
use crate::model_error::{BandDesign, ErrorBands};
use crate::threshold::Confidence;

/// Bands about what an ARX error model expects of the residual.
pub struct Mem;

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
    pub(super) fn bands(&self, confidence: Confidence) -> ErrorBands<ModelRun> {
        ErrorBands::new(self.model.run(), self.deviation, confidence)
    }

    /// Samples in which it settles, if it is to be used.
    pub(super) fn settles(&self) -> usize {
        if self.outlasts { 0 } else { self.run_up }
    }

    /// Why its bands are not to be used: they are not narrower than the plain residual's, so that it
    /// explains nothing, or it settles more slowly than could be judged.
    pub(super) fn refusal(&self, diagnoser: &Diagnoser) -> Option<Refusal> {
        let (v, plain) = (self.deviation, self.plain.unwrap_or(diagnoser.constant.deviation));
        if self.outlasts {
            Some(Refusal::Outlasts { run_up: self.run_up })
        } else if v >= plain {
            Some(Refusal::NotNarrower { v, plain })
        } else {
            None
        }
    }
}

impl ResidualDetector for Mem {
    const INFO: Info = Info {
        part: "error model",
        ..Info::band(
            "mem",
            "model error modelling",
            "Bands by model error modelling, ARX error model",
        )
    };
    type Stored = Elsewhere;
    type Held = ModelError;
    type Run = ErrorBands<ModelRun>;

    fn held(diagnoser: &Diagnoser) -> Option<&ModelError> {
        Some(&diagnoser.model_error)
    }

    fn start(held: &ModelError, confidence: Confidence) -> Result<Self::Run, DetectorError> {
        Ok(held.bands(confidence))
    }

    fn settles(held: &ModelError) -> usize {
        held.settles()
    }

    fn refusal(held: &ModelError, diagnoser: &Diagnoser) -> Option<Refusal> {
        held.refusal(diagnoser)
    }

    fn check(held: &ModelError, inputs: usize) -> Result<(), Flaw> {
        Flaw::of_model("error model", &held.model, inputs)?;
        Flaw::unless_positive("model_error.deviation", held.deviation)
    }
}
