//! What a diagnosis says.

mod blocks;
#[cfg(test)]
mod tests;
pub(crate) mod words;

use std::collections::BTreeMap;
use std::path::PathBuf;

use drivescope_monitor::{Declaration, Fault, Found, Method};
use serde::Serialize;

use crate::commands::Stream;

/// What a diagnosis says.
#[derive(Debug, Serialize)]
pub(crate) struct DiagnoseAnswer {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) diagnoser: Option<PathBuf>,
    pub(crate) recording: String,
    pub(crate) samples: usize,
    /// How the rows of a stream arrived.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) stream: Option<Stream>,
    pub(crate) run_up: usize,
    /// Samples at operating points that the detectors of the residual were not designed on.
    pub(crate) beyond_range: usize,
    /// `healthy`, `fault`, `abnormal` or `not_judged`, by the method that was asked for.
    pub(crate) verdict: &'static str,
    /// Why nothing was judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) why: Option<String>,
    pub(crate) method: Method,
    pub(crate) declarations: Vec<Declaration>,
    /// Share of judged values outside; none if nothing was judged.
    pub(crate) share_outside: Option<f64>,
    /// The fault of the declaration that stood longest; none where no fault is known by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fault: Option<Fault>,
    /// Where the machine was learned from, and what it differs by from the drive, as fractions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) baseline: Option<BaselineAnswer>,
    pub(crate) methods: Vec<Found>,
}

/// What a bank learned of the machine.
#[derive(Debug, Serialize)]
pub(crate) struct BaselineAnswer {
    pub(crate) recording: String,
    pub(crate) samples: usize,
    pub(crate) machine: BTreeMap<String, f64>,
}
