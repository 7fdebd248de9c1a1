//! What a detector of the residual is.

use std::fmt;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::running::ResidualTest;
use crate::data::{Data, DataError};
use crate::detector::DetectorError;
use crate::flaw::Flaw;
use crate::memory::Memory;
use crate::model::ModelRun;
use crate::parts::Parts;
use crate::threshold::Confidence;

/// What a person and the lists of the program need to know of a detector.
#[derive(Debug, Clone, Copy)]
pub struct Info {
    /// Name in files and options; that of its file, too.
    pub id: &'static str,
    /// Name for people.
    pub label: &'static str,
    /// What it is, in a line, for the help.
    pub about: &'static str,
    /// What a diagnoser holds for it.
    pub part: &'static str,
    /// A word that its tables show in the place of a significance level; none where its level is beta.
    /// Its numbers are those of its design, which [`ResidualDetector::designed`] says.
    pub instead_of_level: Option<&'static str>,
    /// Whether a decision rests on the residuals before it, so that one exceedance declares a fault;
    /// else as many in a row as the diagnoser says.
    pub is_sequential: bool,
}

impl Info {
    /// A band about the residual, of the diagnoser's significance level.
    pub const fn band(id: &'static str, label: &'static str, about: &'static str) -> Self {
        let part = label;
        Self { id, label, about, part, instead_of_level: None, is_sequential: false }
    }
}

/// A detector of the residual as the registry knows it.
pub trait ResidualDetector {
    /// What it is called.
    const INFO: Info;
    /// What the diagnoser file holds of it under `[detectors]`, by its id.
    type Stored: fmt::Debug + Clone + PartialEq + Serialize + DeserializeOwned;
    /// What it rests on in a diagnoser.
    type Held;
    /// The detector at work.
    type Run: ResidualTest + Memory + fmt::Debug;

    /// Designs it on a healthy residual, the output of `healthy`, and its inputs, from sample
    /// `run_up` of every segment on; nothing where it is stored elsewhere or the data do not bear it.
    ///
    /// # Errors
    /// Data that do not serve.
    fn design(
        _healthy: &Data,
        _run_up: usize,
        _confidence: Confidence,
    ) -> Result<Option<Self::Stored>, DataError> {
        Ok(None)
    }

    /// What it rests on: what the diagnoser file holds of it, or a part that has a key of its own
    /// there; nothing if the diagnoser was made without.
    fn held<'a>(parts: &Parts<'a>, stored: Option<&'a Self::Stored>) -> Option<&'a Self::Held>;

    /// The detector at its start.
    ///
    /// # Errors
    /// A design that is damaged.
    fn start(held: &Self::Held, confidence: Confidence) -> Result<Self::Run, DetectorError>;

    /// The model whose residual it watches, at its start.
    fn process(_held: &Self::Held, parts: &Parts<'_>) -> ModelRun {
        parts.model.run()
    }

    /// Samples that its models need to settle.
    fn settles(_held: &Self::Held) -> usize {
        0
    }

    /// Why it is not to be used, though it is there.
    fn refusal(_held: &Self::Held, _parts: &Parts<'_>) -> Option<Refusal> {
        None
    }

    /// Checks what a file held for a process of that many inputs.
    ///
    /// # Errors
    /// What cannot run or has no meaning.
    fn check(held: &Self::Held, inputs: usize) -> Result<(), Flaw>;

    /// What was designed, in a line for `train`; `unit` is that of the output. Nothing for those that
    /// `train` tells more of.
    fn designed(_held: &Self::Held, _unit: &str) -> Option<String> {
        None
    }
}

/// What is held of a detector whose design has a key of its own in the diagnoser file: nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Elsewhere {}

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
