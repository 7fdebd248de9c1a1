//! Why a call is not answered with OK, and which status and log category that is.

use super::phase::Phase;
use crate::description::{Causality, LogCategory, Type, Variability, Version};
use crate::vocabulary::Interface;

/// The status of both standards (FMI 2.0.4 section 2.1.3, FMI 3.0.2 section 2.2.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum Status {
    /// All well.
    Ok = 0,
    /// Not quite right, goes on.
    Warning = 1,
    /// Not possible as asked; the importer may ask otherwise.
    Discard = 2,
    /// Refused or failed.
    Error = 3,
    /// The instance is lost.
    Fatal = 4,
}

/// A call that is not answered with OK.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// An argument that must not be NULL is.
    #[error("a pointer argument is NULL where {0} value(s) are expected")]
    NullPointer(usize),
    /// A pointer is not aligned, or the array would not fit in memory.
    #[error("a pointer argument is misaligned or its length {0} is impossible")]
    BadPointer(usize),
    /// A string is not UTF-8.
    #[error("a string argument is not UTF-8")]
    NotUtf8,
    /// An instance name must have a character that is not blank.
    #[error("the instance name is empty")]
    EmptyName,
    /// The importer's token belongs to another FMU.
    #[error(
        "the instantiation token (GUID) is {given} and this model's is {own}: description and library do not belong together"
    )]
    Token {
        given: String,
        /// The model's.
        own: String,
    },
    /// The model's own description is not allowed.
    #[error("the model describes itself wrongly: {0}")]
    Description(#[from] crate::description::DescriptionError),
    /// An optional function, interface or mode that the model does not offer.
    #[error("{0} is not offered; see the capability flags of the model description")]
    NotOffered(&'static str),
    /// The instance was made by the functions of the other version.
    #[error("the instance belongs to FMI {0:?}")]
    OtherVersion(Version),
    /// The function belongs to the other interface.
    #[error("the instance is of type {0:?}, for which this function does not exist")]
    OtherInterface(Interface),
    /// The function may not be called now.
    #[error("not allowed in state {now:?}, only in {allowed:?}")]
    WrongPhase {
        /// Present state.
        now: Phase,
        /// States in which the call is allowed.
        allowed: &'static [Phase],
    },
    /// FMI 2.0: fmi2SetupExperiment is missing.
    #[error("fmi2SetupExperiment must be called first: the start time is not known")]
    NoExperiment,
    /// An experiment that is none.
    #[error(
        "experiment: start {start}, stop {stop:?} (after start), tolerance {tolerance:?} (> 0)"
    )]
    Experiment {
        /// Start time, s.
        start: f64,
        /// Stop time, s.
        stop: Option<f64>,
        /// Relative tolerance.
        tolerance: Option<f64>,
    },
    /// No variable has this value reference.
    #[error("value reference {0} does not exist")]
    UnknownReference(u32),
    /// The function is for another type.
    #[error("variable {name} (value reference {reference}) is a {kind:?}, not a {asked}")]
    WrongKind {
        reference: u32,
        name: String,
        kind: Type,
        /// The type that the function is for.
        asked: &'static str,
    },
    /// Arrays of different lengths.
    #[error("{given} value(s) given where {expected} are expected")]
    Length {
        /// Length as given.
        given: usize,
        /// Length wanted.
        expected: usize,
    },
    /// The model has no value for it.
    #[error("variable {0} has no value now")]
    NoValue(String),
    /// The variable may not be set now.
    #[error("variable {name} ({causality:?}, {variability:?}) may not be set in state {now:?}")]
    NotSettable {
        name: String,
        causality: Causality,
        variability: Variability,
        /// Present state.
        now: Phase,
    },
    /// A discrete variable is held in Continuous-Time Mode.
    #[error(
        "variable {name} changes at events only: {held} is kept and {given} not taken; set it in Event Mode"
    )]
    Held {
        name: String,
        /// The value that it keeps.
        held: f64,
        given: f64,
    },
    /// NaN, infinite, or not of the type.
    #[error("{what} is {value}, which is not allowed")]
    Value {
        /// The variable or argument.
        what: String,
        value: f64,
    },
    /// Outside of min and max.
    #[error("variable {name}: {value} is not allowed, it must be {}", allowed(*min, *max))]
    Range {
        name: String,
        value: f64,
        /// Least value.
        min: Option<f64>,
        /// Greatest value.
        max: Option<f64>,
    },
    /// A communication step that is not positive.
    #[error("communication step size {0} s is not positive")]
    StepSize(f64),
    /// A step that does not begin where the last one ended.
    #[error("the step begins at {given} s and the instance is at {own} s")]
    CommunicationPoint {
        /// Communication point given, s.
        given: f64,
        /// The instance's time, s.
        own: f64,
    },
    /// A step beyond the stop time.
    #[error("the step ends at {end} s, beyond the stop time {stop} s")]
    BeyondStop {
        /// End of the step, s.
        end: f64,
        /// Stop time, s.
        stop: f64,
    },
    /// A result that the importer's solver must not use.
    #[error("{0} is not finite; take a smaller step")]
    NotFinite(&'static str),
    /// Another status information than the one that exists.
    #[error("status information of kind {0} is not available: no step is pending")]
    NoStatus(i32),
    /// No such derivative.
    #[error("no derivative of these unknowns with respect to these knowns")]
    NoDerivative,
    /// Not an FMU state of this instance.
    #[error("FMU state {0:#x} is not one of this instance's, or was freed")]
    UnknownState(usize),
    /// Bytes that are not an FMU state of this FMU.
    #[error("serialized FMU state: {0}")]
    Serialized(#[from] super::snapshots::SerializedError),
    /// A log category that does not exist.
    #[error("log category `{0}` does not exist")]
    UnknownCategory(String),
    /// An error of the model.
    #[error("{while_doing}: {message}")]
    Model {
        /// What was asked of the model.
        while_doing: &'static str,
        /// The model's error with its sources.
        message: String,
        /// Whether the model is no longer consistent.
        ends_run: bool,
    },
    /// The model panicked.
    #[error("internal error: {0}; free this instance")]
    Panicked(String),
    /// A call after a panic.
    #[error("the instance was lost by an earlier internal error; free it")]
    Lost,
}

impl Refusal {
    /// An error of the model after which it is as before.
    pub(super) fn model(while_doing: &'static str, error: &dyn std::error::Error) -> Self {
        Self::Model { while_doing, message: chain(error), ends_run: false }
    }

    /// An error of the model after which its run cannot go on.
    pub(super) fn ending(while_doing: &'static str, error: &dyn std::error::Error) -> Self {
        Self::Model { while_doing, message: chain(error), ends_run: true }
    }

    pub(super) fn status(&self) -> Status {
        match self {
            Self::Held { .. } => Status::Warning,
            Self::NotFinite(_) | Self::NoStatus(_) => Status::Discard,
            Self::Panicked(_) | Self::Lost => Status::Fatal,
            _ => Status::Error,
        }
    }
}

impl Status {
    pub(super) fn category(self) -> LogCategory {
        match self {
            Self::Ok => LogCategory::Events,
            Self::Warning => LogCategory::StatusWarning,
            Self::Discard => LogCategory::StatusDiscard,
            Self::Error => LogCategory::StatusError,
            Self::Fatal => LogCategory::StatusFatal,
        }
    }
}

/// The values between those limits, in words. FMI has closed limits only: the least positive number
/// stands for 0 where that is left out.
fn allowed(min: Option<f64>, max: Option<f64>) -> String {
    let least = min.map(|min| match min {
        f64::MIN_POSITIVE => "above 0".to_owned(),
        min => format!("{min} or more"),
    });
    match (least, max) {
        (Some(least), Some(max)) => format!("{least} and at most {max}"),
        (Some(least), None) => least,
        (None, Some(max)) => format!("at most {max}"),
        (None, None) => "a number".to_owned(),
    }
}

/// Refuses an array of another length.
pub(super) fn same_length(given: usize, expected: usize) -> Result<(), Refusal> {
    if given == expected { Ok(()) } else { Err(Refusal::Length { given, expected }) }
}

fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        text = format!("{text}: {error}");
        source = error.source();
    }
    text
}
