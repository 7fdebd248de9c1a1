//! Constant thresholds: mean +- t_beta std of a healthy residual.

use super::law::{Elsewhere, Info, ResidualDetector};
use crate::constant_threshold::ConstantThreshold;
use crate::detector::DetectorError;
use crate::flaw::Flaw;
use crate::parts::Parts;
use crate::threshold::{Band, Confidence};

/// A band that never moves.
pub struct Constant;

impl ResidualDetector for Constant {
    const INFO: Info = Info::band("constant", "constant thresholds", "Constant thresholds");
    type Stored = Elsewhere;
    type Held = ConstantThreshold;
    type Run = Band;

    fn held<'a>(parts: &Parts<'a>, _: Option<&'a Elsewhere>) -> Option<&'a ConstantThreshold> {
        Some(parts.constant)
    }

    fn start(held: &ConstantThreshold, confidence: Confidence) -> Result<Band, DetectorError> {
        Ok(held.band(confidence))
    }

    fn check(held: &ConstantThreshold, _: usize) -> Result<(), Flaw> {
        Flaw::unless_positive("constant.deviation", held.deviation)?;
        Flaw::unless_finite("constant.mean", held.mean)
    }
}
