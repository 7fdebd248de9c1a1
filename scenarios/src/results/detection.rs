//! What every detector detected, and its false alarms.

use drivescope_diagnoser::DetectorKind;
use serde::{Deserialize, Serialize};

use super::{ByDetector, FaultName, TorqueReading};

/// How one detector saw one fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DetectionRow {
    pub fault: FaultName,
    /// The detector.
    pub method: DetectorKind,
    /// Share of faulty samples outside the threshold.
    pub r_td: f64,
    /// Sample at which the fault was declared, none if it was not; a run of exceedances that most
    /// of lies in the fault counts for it, so that chance may put this before start + window.
    pub t_dt: Option<usize>,
    /// Samples from the fault's start to its declaration.
    pub delay: Option<usize>,
    /// Declarations before that, which are none of the fault.
    pub false_alarms: usize,
}

impl DetectionRow {
    /// Whether the fault was declared, and nothing before it.
    pub fn detected(&self) -> bool {
        self.t_dt.is_some() && self.false_alarms == 0
    }
}

/// The rows of one reading of the torque fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReadingRows {
    /// The reading.
    pub torque: TorqueReading,
    /// One row a fault and detector.
    pub detection: Vec<DetectionRow>,
}

/// What changes where the bands are designed for another significance level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelRows {
    /// Significance level beta.
    pub beta: f64,
    /// Share of healthy samples outside, by detector.
    pub r_fd: ByDetector,
    /// Faults declared on healthy runs.
    pub alarms: ByDetector<usize>,
    /// One row a fault and detector.
    pub detection: Vec<DetectionRow>,
    /// The rows of the other readings.
    pub readings: Vec<ReadingRows>,
}

/// Healthy evaluation runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HealthySummary {
    /// Samples judged, run-up excluded.
    pub samples: usize,
    pub runs: usize,
    /// Samples of each run that are not judged, from its start.
    pub run_up: usize,
    /// Faults declared.
    pub alarms: ByDetector<usize>,
}

/// A run beside the twelve: other kinds of faults, or several at once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FurtherRun {
    /// The faults, as they were typed.
    pub faults: String,
    /// One row a detector.
    pub detection: Vec<DetectionRow>,
}
