//! The methods that can be asked for.

use clap::ValueEnum;
use drivescope_scenarios::results::Method as OfPaper;
use serde::Serialize;

/// A method of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[value(rename_all = "snake_case")]
#[serde(rename_all = "snake_case")]
pub(super) enum Method {
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
    /// The detectors of the paper.
    pub(super) const OF_PAPER: [Self; 4] =
        [Self::Mem, Self::MemRecurrent, Self::Constant, Self::Gmdh];

    /// As the study knows it.
    pub(super) fn of_paper(self) -> Option<OfPaper> {
        match self {
            Self::Bank | Self::Windows => None,
            Self::Mem => Some(OfPaper::Mem),
            Self::MemRecurrent => Some(OfPaper::MemRecurrent),
            Self::Constant => Some(OfPaper::Constant),
            Self::Gmdh => Some(OfPaper::Gmdh),
        }
    }

    /// Name for people.
    pub(super) fn label(self) -> &'static str {
        match self {
            Self::Bank => "bank of hypotheses",
            Self::Windows => "windows against the baseline",
            Self::Mem | Self::MemRecurrent | Self::Constant | Self::Gmdh => {
                self.of_paper().map_or("", OfPaper::label)
            }
        }
    }
}
