//! What every method detected, and its false alarms.

use drivescope_diagnoser::ThresholdKind;
use serde::{Deserialize, Serialize};

use super::{FaultName, TorqueReading};

/// A way of watching the residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Adaptive bands by model error modelling, ARX error model.
    Mem,
    /// The same with a recurrent error model.
    MemRecurrent,
    /// Constant thresholds.
    Constant,
    /// Intervals of the GMDH network with bounded parameters.
    Gmdh,
}

impl Method {
    /// Every method of the study, in the order of the tables.
    pub const ALL: [Self; 4] = [Self::Mem, Self::MemRecurrent, Self::Constant, Self::Gmdh];
    /// Those of which the paper has figures.
    pub const IN_PAPER: [Self; 2] = [Self::Mem, Self::Constant];

    /// The threshold of a diagnoser that it is.
    pub fn kind(self) -> ThresholdKind {
        match self {
            Self::Mem => ThresholdKind::ModelError,
            Self::MemRecurrent => ThresholdKind::RecurrentModelError,
            Self::Constant => ThresholdKind::Constant,
            Self::Gmdh => ThresholdKind::Gmdh,
        }
    }

    /// Name for people.
    pub fn label(self) -> &'static str {
        self.kind().label()
    }
}

/// How one method saw one fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DetectionRow {
    /// The fault.
    pub fault: FaultName,
    /// The method.
    pub method: Method,
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
    /// One row a fault and method.
    pub detection: Vec<DetectionRow>,
}

/// What changes where the bands are designed for another significance level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelRows {
    /// Significance level beta.
    pub beta: f64,
    /// Share of healthy samples outside, by method.
    pub r_fd: ByMethod,
    /// Faults declared on healthy runs.
    pub alarms: ByMethod<usize>,
    /// One row a fault and method.
    pub detection: Vec<DetectionRow>,
    /// The rows of the other readings.
    pub readings: Vec<ReadingRows>,
}

/// A number for each method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ByMethod<T = f64> {
    /// Model error modelling, ARX error model.
    pub mem: T,
    /// The same with a recurrent error model.
    pub mem_recurrent: T,
    /// Constant thresholds.
    pub constant: T,
    /// Robust GMDH network.
    pub gmdh: T,
}

impl<T> ByMethod<T> {
    /// One value a method.
    pub fn from_fn(mut value: impl FnMut(Method) -> T) -> Self {
        Self {
            mem: value(Method::Mem),
            mem_recurrent: value(Method::MemRecurrent),
            constant: value(Method::Constant),
            gmdh: value(Method::Gmdh),
        }
    }

    /// The one of this method.
    pub fn get(&self, method: Method) -> &T {
        match method {
            Method::Mem => &self.mem,
            Method::MemRecurrent => &self.mem_recurrent,
            Method::Constant => &self.constant,
            Method::Gmdh => &self.gmdh,
        }
    }

    /// The one of this method, to change.
    pub fn get_mut(&mut self, method: Method) -> &mut T {
        match method {
            Method::Mem => &mut self.mem,
            Method::MemRecurrent => &mut self.mem_recurrent,
            Method::Constant => &mut self.constant,
            Method::Gmdh => &mut self.gmdh,
        }
    }
}

impl<T: Copy> ByMethod<T> {
    /// The one of this method.
    pub fn of(&self, method: Method) -> T {
        *self.get(method)
    }
}

/// Healthy evaluation runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HealthySummary {
    /// Samples judged, run-up excluded.
    pub samples: usize,
    /// Runs.
    pub runs: usize,
    /// Samples of each run that are not judged, from its start.
    pub run_up: usize,
    /// Faults declared.
    pub alarms: ByMethod<usize>,
}

/// A run beside the twelve: other kinds of faults, or several at once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FurtherRun {
    /// The faults, as they were typed.
    pub faults: String,
    /// One row a method.
    pub detection: Vec<DetectionRow>,
}
