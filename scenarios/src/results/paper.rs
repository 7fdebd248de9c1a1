//! Figures of the reference paper.

use serde::{Deserialize, Serialize};

use super::DetectorKind;

/// The detectors of which the paper has figures.
pub const IN_PAPER: [DetectorKind; 2] = [DetectorKind::Mem, DetectorKind::Constant];
/// Those that it describes without figures for this motor.
pub const DESCRIBED: [DetectorKind; 2] = [DetectorKind::MemRecurrent, DetectorKind::Gmdh];

/// Figures of the reference paper, for the tables.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PaperFigures {
    /// Table 1, a row a fault and method.
    pub detection: Vec<PaperRow>,
    /// False detection rates.
    pub r_fd: PaperRates,
    /// Sum of squared errors of the paper's ARX error model over 3000 samples.
    pub arx_sse: f64,
    /// Table 2: shares, a row a fault, a column a class C_1 .. C_10.
    pub isolation: Vec<Vec<f64>>,
}

/// The paper's false detection rates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PaperRates {
    /// Model error modelling.
    pub mem: f64,
    /// Constant thresholds.
    pub constant: f64,
}

impl PaperRates {
    /// The one of this method, if the paper has it.
    pub fn of(&self, method: DetectorKind) -> Option<f64> {
        match method {
            DetectorKind::Mem => Some(self.mem),
            DetectorKind::Constant => Some(self.constant),
            _ => None,
        }
    }
}

/// A row of the paper's Table 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PaperRow {
    /// The paper's label.
    pub label: String,
    pub method: DetectorKind,
    /// Share of faulty samples outside the threshold.
    pub r_td: f64,
    /// Sample of the declaration.
    pub t_dt: usize,
}
