//! A diagnoser: trained models, thresholds and decision for one set of signals.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use drivescope_recording::Recording;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::bank::BankDesign;
use crate::decision::Trace;
use crate::detector::{Detector, DetectorError};
use crate::gmdh::{GmdhBands, RobustGmdh};
use crate::interface::{Interface, InterfaceError};
use crate::isolation::KnownFaults;
use crate::memory::{Memory, MemoryError, Walk};
use crate::model::{Model, ModelRun};
use crate::model_error::{BandDesign, ErrorBands};
use crate::range::OperatingRange;
use crate::threshold::{Band, Confidence, ConstantThreshold, Threshold};
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
}

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
}

/// Why an error model is not used.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Refusal {
    /// Its bands are not narrower than those of the plain residual.
    #[error("its bands are not narrower than the plain residual's (v = {v:.4}, plain {plain:.4})")]
    NotNarrower {
        /// Standard deviation of r - y_e, output unit.
        v: f64,
        /// That of r over the same samples.
        plain: f64,
    },
    /// It settles more slowly than the healthy recordings are long.
    #[error("it settles in {run_up} samples, more than half of the healthy recordings")]
    Outlasts {
        /// Five of its slowest time constants, samples.
        run_up: usize,
    },
}

/// Which threshold a detector uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ThresholdKind {
    /// Bands of model error modelling, (6) and (7).
    ModelError,
    /// The same with the recurrent error model.
    RecurrentModelError,
    /// Mean +- t_beta std.
    Constant,
    /// Output intervals of the GMDH network with bounded parameters (19), around its own output; no
    /// significance level enters.
    Gmdh,
}

impl ThresholdKind {
    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::ModelError => "model error modelling",
            Self::RecurrentModelError => "recurrent error model",
            Self::Constant => "constant thresholds",
            Self::Gmdh => "robust GMDH network",
        }
    }
}

/// A stored threshold, running.
#[derive(Debug, Clone)]
pub enum ThresholdRun {
    /// Bands of model error modelling.
    ModelError(ErrorBands<ModelRun>),
    /// Constant thresholds.
    Constant(Band),
    /// The adaptive threshold (19).
    Gmdh(GmdhBands),
}

impl Threshold for ThresholdRun {
    fn reset(&mut self) {
        match self {
            Self::ModelError(bands) => bands.reset(),
            Self::Constant(band) => band.reset(),
            Self::Gmdh(bands) => bands.reset(),
        }
    }

    fn settle(&mut self, u: &[f64]) {
        match self {
            Self::ModelError(bands) => bands.settle(u),
            Self::Constant(band) => band.settle(u),
            Self::Gmdh(bands) => bands.settle(u),
        }
    }

    #[inline]
    fn band(&mut self, u: &[f64]) -> Band {
        match self {
            Self::ModelError(bands) => bands.band(u),
            Self::Constant(band) => band.band(u),
            Self::Gmdh(bands) => bands.band(u),
        }
    }
}

impl Memory for ThresholdRun {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        match self {
            Self::ModelError(bands) => bands.walk(walk),
            Self::Constant(_) => Ok(()),
            Self::Gmdh(bands) => bands.walk(walk),
        }
    }
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
    /// Why the bands (6), (7) of an error model are not to be used: they are not narrower than the
    /// plain residual's, so that it explains nothing, or it settles more slowly than could be judged.
    /// Nothing of a threshold without an error model.
    pub fn refusal(&self, kind: ThresholdKind) -> Option<Refusal> {
        let error = self.error_model(kind)?;
        let plain = error.plain.unwrap_or(self.constant.deviation);
        if error.outlasts {
            Some(Refusal::Outlasts { run_up: error.run_up })
        } else if error.deviation >= plain {
            Some(Refusal::NotNarrower { v: error.deviation, plain })
        } else {
            None
        }
    }

    /// Whether a threshold is to be used.
    pub fn explains(&self, kind: ThresholdKind) -> bool {
        self.refusal(kind).is_none()
    }

    /// The error model of a threshold, if it has one.
    fn error_model(&self, kind: ThresholdKind) -> Option<&ModelError> {
        match kind {
            ThresholdKind::ModelError => Some(&self.model_error),
            ThresholdKind::RecurrentModelError => self.recurrent_error.as_ref(),
            ThresholdKind::Constant | ThresholdKind::Gmdh => None,
        }
    }

    /// Samples at the start of a run that a detector does not judge: those in which its models settle.
    pub fn run_up_of(&self, kind: ThresholdKind) -> usize {
        let usable = self.error_model(kind).filter(|error| !error.outlasts);
        self.run_up.max(usable.map_or(0, |error| error.run_up))
    }

    /// A detector at its start, with the diagnoser's own significance level.
    pub fn detector(
        &self,
        kind: ThresholdKind,
    ) -> Result<Detector<ModelRun, ThresholdRun>, DetectorError> {
        self.detector_at(kind, self.confidence)
    }

    /// A detector at its start, at another significance level.
    pub fn detector_at(
        &self,
        kind: ThresholdKind,
        confidence: Confidence,
    ) -> Result<Detector<ModelRun, ThresholdRun>, DetectorError> {
        let bands = |ModelError { deviation, model, .. }: &ModelError| {
            ThresholdRun::ModelError(ErrorBands::new(model.run(), *deviation, confidence))
        };
        let threshold = match kind {
            ThresholdKind::ModelError => bands(&self.model_error),
            ThresholdKind::RecurrentModelError => {
                let part = "recurrent error model";
                bands(self.recurrent_error.as_ref().ok_or(DetectorError::Missing { part })?)
            }
            ThresholdKind::Constant => ThresholdRun::Constant(self.constant.band(confidence)),
            ThresholdKind::Gmdh => {
                let part = "GMDH network";
                let robust = self.gmdh.as_ref().ok_or(DetectorError::Missing { part })?;
                let bands = robust.bands().map_err(|_| DetectorError::DamagedBounds)?;
                let model = ModelRun::Gmdh(robust.network.run());
                return Detector::new(model, ThresholdRun::Gmdh(bands), self.window, self.run_up);
            }
        };
        Detector::new(self.model.run(), threshold, self.window, self.run_up_of(kind))
    }

    /// Runs over a recording of the signals it was trained on.
    pub fn diagnose(
        &self,
        recording: &Recording,
        kind: ThresholdKind,
    ) -> Result<Trace, DiagnosisError> {
        let data = self.interface.select(recording)?;
        Ok(self.detector(kind)?.run(&data)?)
    }
}
