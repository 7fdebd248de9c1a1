//! `--rule`: by which rule a missing effect is named.

use clap::ValueEnum;
use drivescope_discovery::Rule;

/// The rules.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum RuleName {
    /// Gains in BIC, tests and shapes, each with its threshold.
    Gates,
    /// The evidence of one model with a random load in it: on trial, and slower.
    Evidence,
}

impl From<RuleName> for Rule {
    fn from(name: RuleName) -> Self {
        match name {
            RuleName::Gates => Self::Gates,
            RuleName::Evidence => Self::Evidence,
        }
    }
}
