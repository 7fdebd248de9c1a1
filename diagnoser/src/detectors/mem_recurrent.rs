//! Model error modelling, (6) and (7), with a recurrent network as error model.

use super::law::{Elsewhere, Info, Refusal, ResidualDetector};
use super::mem::refusal;
use crate::detector::DetectorError;
use crate::flaw::Flaw;
use crate::model::ModelRun;
use crate::model_error::ErrorBands;
use crate::parts::Parts;
use crate::stored_error::ModelError;
use crate::threshold::Confidence;

/// Bands about what a recurrent error model expects of the residual.
pub struct MemRecurrent;

impl ResidualDetector for MemRecurrent {
    const INFO: Info = Info::band(
        "mem_recurrent",
        "recurrent error model",
        "The same with the recurrent error model",
    );
    type Stored = Elsewhere;
    type Held = ModelError;
    type Run = ErrorBands<ModelRun>;

    fn held<'a>(parts: &Parts<'a>, _: Option<&'a Elsewhere>) -> Option<&'a ModelError> {
        parts.recurrent_error
    }

    fn start(held: &ModelError, confidence: Confidence) -> Result<Self::Run, DetectorError> {
        Ok(held.bands(confidence))
    }

    fn settles(held: &ModelError) -> usize {
        held.settles()
    }

    fn refusal(held: &ModelError, parts: &Parts<'_>) -> Option<Refusal> {
        refusal(held, parts)
    }

    fn check(held: &ModelError, inputs: usize) -> Result<(), Flaw> {
        Flaw::of_model("recurrent error model", &held.model, inputs)?;
        Flaw::unless_positive("recurrent_error.deviation", held.deviation)
    }
}
