//! The methods of a diagnosis.

use drivescope_diagnoser::{Diagnoser, ThresholdKind};
use serde::Serialize;

/// A method of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The bank of hypotheses over the drive's equations; the default where the diagnoser has one.
    Bank,
    /// Windows of the residual against a baseline; the default where one is given and there is no
    /// bank.
    Windows,
    /// Bands by model error modelling, ARX error model; else the default.
    Mem,
    /// The same with the recurrent error model.
    MemRecurrent,
    /// Constant thresholds.
    Constant,
    /// Intervals of the GMDH network.
    Gmdh,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Bank, Self::Windows, Self::Mem, Self::MemRecurrent, Self::Constant, Self::Gmdh];
    /// The detectors of the paper.
    pub const OF_PAPER: [Self; 4] = [Self::Mem, Self::MemRecurrent, Self::Constant, Self::Gmdh];

    /// Name in files and options.
    pub fn id(self) -> &'static str {
        match self {
            Self::Bank => "bank",
            Self::Windows => "windows",
            Self::Mem => "mem",
            Self::MemRecurrent => "mem_recurrent",
            Self::Constant => "constant",
            Self::Gmdh => "gmdh",
        }
    }

    /// The threshold of a detector of the paper.
    pub fn threshold(self) -> Option<ThresholdKind> {
        match self {
            Self::Bank | Self::Windows => None,
            Self::Mem => Some(ThresholdKind::ModelError),
            Self::MemRecurrent => Some(ThresholdKind::RecurrentModelError),
            Self::Constant => Some(ThresholdKind::Constant),
            Self::Gmdh => Some(ThresholdKind::Gmdh),
        }
    }

    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Bank => "bank of hypotheses",
            Self::Windows => "windows against the baseline",
            Self::Mem | Self::MemRecurrent | Self::Constant | Self::Gmdh => {
                self.threshold().map_or("", ThresholdKind::label)
            }
        }
    }

    /// Whether the diagnoser holds what a detector of the paper needs.
    pub(crate) fn is_held(self, diagnoser: &Diagnoser) -> bool {
        match self {
            Self::MemRecurrent => diagnoser.recurrent_error.is_some(),
            Self::Gmdh => diagnoser.gmdh.is_some(),
            _ => true,
        }
    }

    /// The best that a diagnoser has, with or without a baseline of the machine.
    pub fn best(diagnoser: &Diagnoser, baseline: bool) -> Self {
        if diagnoser.bank.is_some() {
            Self::Bank
        } else if baseline && diagnoser.windows.is_some() {
            Self::Windows
        } else if diagnoser.explains(ThresholdKind::ModelError) {
            Self::Mem
        } else {
            Self::Constant
        }
    }
}
