//! Model error modelling, (6) and (7), with the ARX error model.

use super::law::{Elsewhere, Info, Refusal, ResidualDetector};
use crate::detector::DetectorError;
use crate::flaw::Flaw;
use crate::model::ModelRun;
use crate::model_error::ErrorBands;
use crate::parts::Parts;
use crate::stored_error::ModelError;
use crate::threshold::Confidence;

/// Bands about what an ARX error model expects of the residual.
pub struct Mem;

/// Why bands are not to be used: they are not narrower than the plain residual's, so that the error
/// model explains nothing, or it settles more slowly than could be judged.
pub(super) fn refusal(held: &ModelError, parts: &Parts<'_>) -> Option<Refusal> {
    let (v, plain) = (held.deviation, held.plain.unwrap_or(parts.constant.deviation));
    if held.outlasts {
        Some(Refusal::Outlasts { run_up: held.run_up })
    } else if v >= plain {
        Some(Refusal::NotNarrower { v, plain })
    } else {
        None
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

    fn held<'a>(parts: &Parts<'a>, _: Option<&'a Elsewhere>) -> Option<&'a ModelError> {
        Some(parts.model_error)
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
        Flaw::of_model("error model", &held.model, inputs)?;
        Flaw::unless_positive("model_error.deviation", held.deviation)
    }
}
