//! The life of an instance.

/// Where an instance is in its life (FMI 2.0 section 4.2.4, FMI 3.0 section 2.3.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    Instantiated,
    Initialization,
    Stepping,
    Terminated,
    Failed,
    Corrupt,
}

impl Mode {
    pub(super) fn name(self) -> &'static str {
        match self {
            Mode::Instantiated => "not initialised",
            Mode::Initialization => "being initialised",
            Mode::Stepping => "running",
            Mode::Terminated => "terminated",
            Mode::Failed => "in an error state (reset it first)",
            Mode::Corrupt => "corrupt after a fatal error (make a new one)",
        }
    }
}
