//! Output intervals of the GMDH network with bounded parameters (19), around its own output.

use std::sync::Arc;

use super::law::{Elsewhere, Info, ResidualDetector};
use crate::detector::DetectorError;
use crate::flaw::Flaw;
use crate::gmdh::{GmdhBands, RobustGmdh};
use crate::model::{Model, ModelRun};
use crate::parts::Parts;
use crate::threshold::Confidence;

/// The adaptive threshold (19) about the network's own residual; no significance level enters.
pub struct Gmdh;

impl ResidualDetector for Gmdh {
    const INFO: Info = Info {
        part: "GMDH network",
        instead_of_level: Some("bounded"),
        ..Info::band("gmdh", "robust GMDH network", "Intervals of the GMDH network")
    };
    type Stored = Elsewhere;
    type Held = RobustGmdh;
    type Run = GmdhBands;

    fn held<'a>(parts: &Parts<'a>, _: Option<&'a Elsewhere>) -> Option<&'a RobustGmdh> {
        parts.gmdh
    }

    fn start(held: &RobustGmdh, _: Confidence) -> Result<GmdhBands, DetectorError> {
        held.bands().map_err(|_| DetectorError::DamagedBounds)
    }

    fn process(held: &RobustGmdh, _: &Parts<'_>) -> ModelRun {
        ModelRun::Gmdh(held.network.run())
    }

    fn check(held: &RobustGmdh, inputs: usize) -> Result<(), Flaw> {
        Flaw::of_model("GMDH network", &Model::Gmdh(Arc::clone(&held.network)), inputs)?;
        held.bands()?;
        Ok(())
    }
}
