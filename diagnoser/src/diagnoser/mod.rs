//! A diagnoser: trained models, thresholds and decision for one set of signals.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use drivescope_recording::Recording;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::bank::BankDesign;
use crate::constant_threshold::ConstantThreshold;
use crate::decision::Trace;
use crate::detector::{Detector, DetectorError};
use crate::detectors::{DetectorKind, DetectorRun, Refusal, Stored};
use crate::gmdh::RobustGmdh;
use crate::interface::{Interface, InterfaceError};
use crate::isolation::KnownFaults;
use crate::model::{Model, ModelRun};
use crate::parts::Parts;
use crate::range::OperatingRange;
use crate::stored_error::ModelError;
use crate::threshold::Confidence;
use crate::windows::Windows;

/// Everything that is needed to watch one output, as it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Diagnoser {
    /// Version of the file format.
    pub schema: u32,
    /// Samples at the start of a run during which the models settle and nothing is judged.
    pub run_up: usize,
    /// Exceedances in a row that declare a fault.
    pub window: usize,
    /// Share of healthy samples expected outside the bands.
    #[serde(rename = "beta")]
    pub confidence: Confidence,
    /// The signals it was trained on.
    pub interface: Interface,
    /// Constant thresholds.
    pub constant: ConstantThreshold,
    /// Model of the output.
    pub model: Model,
    /// Model of what that model gets wrong.
    pub model_error: ModelError,
    /// A second one, by a recurrent network.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recurrent_error: Option<ModelError>,
    /// A model of the output of its own, with bounded parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gmdh: Option<RobustGmdh>,
    /// Faults that it was shown: their classes and sizes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub faults: Option<Arc<KnownFaults>>,
    /// Windows of the residual against a healthy baseline of the machine or day.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub windows: Option<Windows>,
    /// Operating points that it was designed on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<OperatingRange>,
    /// A bank of hypotheses over a drive whose equations are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bank: Option<BankDesign>,
    /// Detectors of the residual beside those above.
    #[serde(default, skip_serializing_if = "Stored::is_empty")]
    pub detectors: Stored,
}

/// Why a recording cannot be diagnosed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DiagnosisError {
    /// Other signals, units or sampling time.
    #[error(transparent)]
    Interface(#[from] InterfaceError),
    /// The detector refuses.
    #[error(transparent)]
    Detector(#[from] DetectorError),
}

impl Diagnoser {
    /// What detectors look at.
    pub(crate) fn parts(&self) -> Parts<'_> {
        Parts {
            interface: &self.interface,
            model: &self.model,
            constant: &self.constant,
            model_error: &self.model_error,
            recurrent_error: self.recurrent_error.as_ref(),
            gmdh: self.gmdh.as_ref(),
        }
    }

    /// Whether it holds what a detector rests on.
    pub fn holds(&self, kind: DetectorKind) -> bool {
        kind.is_held(&self.parts(), &self.detectors)
    }

    /// What was designed of a detector, in a line for people; nothing if that is told elsewhere.
    pub fn designed(&self, kind: DetectorKind) -> Option<String> {
        kind.designed(&self.parts(), &self.detectors)
    }

    /// Why a detector is not to be used, though it is there: an error model that explains nothing of
    /// the residual, or settles more slowly than could be judged.
    pub fn refusal(&self, kind: DetectorKind) -> Option<Refusal> {
        kind.refusal(&self.parts(), &self.detectors)
    }

    /// Whether a detector, if it is there, is to be used.
    pub fn explains(&self, kind: DetectorKind) -> bool {
        self.refusal(kind).is_none()
    }

    /// Samples at the start of a run that a detector does not judge: those in which its models settle.
    pub fn run_up_of(&self, kind: DetectorKind) -> usize {
        self.run_up.max(kind.settles(&self.parts(), &self.detectors))
    }

    /// Exceedances in a row by which a detector declares a fault.
    pub fn window_of(&self, kind: DetectorKind) -> usize {
        if kind.info().is_sequential { 1 } else { self.window }
    }

    /// A detector at its start, with the diagnoser's own significance level.
    ///
    /// # Errors
    /// A diagnoser that does not hold it, or a damaged one.
    pub fn detector(
        &self,
        kind: DetectorKind,
    ) -> Result<Detector<ModelRun, DetectorRun>, DetectorError> {
        self.detector_at(kind, self.confidence)
    }

    /// A detector at its start, at another significance level.
    ///
    /// # Errors
    /// As [`Self::detector`].
    pub fn detector_at(
        &self,
        kind: DetectorKind,
        confidence: Confidence,
    ) -> Result<Detector<ModelRun, DetectorRun>, DetectorError> {
        let (model, test) = kind.start(&self.parts(), &self.detectors, confidence)?;
        Detector::new(model, test, self.window_of(kind), self.run_up_of(kind))
    }

    /// Runs over a recording of the signals it was trained on.
    ///
    /// # Errors
    /// Other signals, or a detector that is not there.
    pub fn diagnose(
        &self,
        recording: &Recording,
        kind: DetectorKind,
    ) -> Result<Trace, DiagnosisError> {
        let data = self.interface.select(recording)?;
        Ok(self.detector(kind)?.run(&data)?)
    }
}
