//! How well the FMU agrees with others.

use serde::{Deserialize, Serialize};

use super::FaultName;

/// How well the FMU agrees with others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FmuSummary {
    /// Greatest difference from the native runs, relative to each signal's greatest magnitude.
    pub max_relative_difference_native: f64,
    /// Runs in fmpy, if they were made.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fmpy: Vec<FmpyRow>,
}

/// One fmpy run against ours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FmpyRow {
    pub fault: FaultName,
    /// Version of FMI: 2 or 3.
    pub fmi: u8,
    /// `CS` or `ME`.
    pub kind: String,
    /// Greatest difference, relative to each signal's greatest magnitude.
    pub max_relative_difference: f64,
}
