//! What is wrong with an FMU.

use super::description::Position;

/// How serious a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Works here, but may not elsewhere.
    Warning,
    /// Against the standard.
    Error,
}

/// One thing that is wrong with an FMU.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// How serious it is.
    pub severity: Severity,
    /// Where in `modelDescription.xml`, if it is there.
    pub place: Option<Position>,
    /// What is wrong.
    pub text: String,
}

impl Finding {
    pub(super) fn error(place: impl Into<Option<Position>>, text: impl Into<String>) -> Finding {
        Finding { severity: Severity::Error, place: place.into(), text: text.into() }
    }

    pub(super) fn warning(place: impl Into<Option<Position>>, text: impl Into<String>) -> Finding {
        Finding { severity: Severity::Warning, place: place.into(), text: text.into() }
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        let severity = if self.severity == Severity::Error { "error" } else { "warning" };
        match self.place {
            Some(Position { line, column }) => {
                write!(out, "{severity}: modelDescription.xml:{line}:{column}: {}", self.text)
            }
            None => write!(out, "{severity}: {}", self.text),
        }
    }
}
