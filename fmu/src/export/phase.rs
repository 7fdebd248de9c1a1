//! Where an instance stands in the standards' state machines, and its run.

/// States of both standards' state machines, as far as we offer them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Start values and parameters are set.
    Instantiated,
    /// Initial unknowns are computed.
    Initialization,
    /// Model Exchange: events happen.
    Event,
    /// Model Exchange: the importer integrates.
    Continuous,
    /// Co-Simulation: between two steps (FMI 2.0 `stepComplete`, FMI 3.0 Step Mode).
    Step,
    /// After the end of a run.
    Terminated,
    /// After an error of the model.
    Failed,
    /// After a panic.
    Lost,
}

/// What a run consists of beside the model; saved and restored with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    pub(super) phase: Phase,
    /// Present time, s.
    pub(super) time: f64,
    /// Stop time, s, where one was defined.
    pub(super) stop: Option<f64>,
    /// The start time was given.
    pub(super) has_experiment: bool,
}

impl Run {
    pub(super) const NEW: Self =
        Self { phase: Phase::Instantiated, time: 0.0, stop: None, has_experiment: false };
}
