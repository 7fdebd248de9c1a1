//! The parts of errors: what exactly is wrong with an archive entry, a variable, an integration or an
//! experiment.

use drivescope_recording::rounded;

/// Why an archive entry is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum UnsafeEntry {
    /// `..` in the path.
    #[error("leads out of the FMU's folder")]
    Escapes,
    /// A path from the root or with a drive letter.
    #[error("has an absolute path")]
    Absolute,
    /// A symbolic link or another special file.
    #[error("is a symbolic link or a special file")]
    Special,
    /// An empty name, or one that file systems do not take.
    #[error("has a name that no file can have")]
    Name,
    /// The same name as an earlier entry.
    #[error("occurs twice")]
    Twice,
}

/// Why a variable cannot be used as asked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VariableProblem {
    /// An array, where a scalar is needed.
    #[error("is an array of {0} elements; only scalars can be connected or stepped")]
    Array(usize),
    /// A string, binary or clock, where a number is needed.
    #[error("is of type {0}, which has no numeric value")]
    NotNumeric(&'static str),
    /// Another type, where a text is needed.
    #[error("is of type {0}, not String")]
    NotText(&'static str),
    /// Another type, where bytes are needed.
    #[error("is of type {0}, not Binary")]
    NotBytes(&'static str),
    /// Another type, where a long whole number is needed.
    #[error("is of type {0}, neither Int64 nor UInt64")]
    NotWhole(&'static str),
    /// Another number of elements.
    #[error("has {there} elements, and {given} are given")]
    Elements {
        /// How many it has.
        there: usize,
        /// How many are given.
        given: usize,
    },
    /// A value that the variable's type cannot hold.
    #[error("is of type {kind} and cannot take the value {value}")]
    Value { kind: &'static str, value: f64 },
    /// A text that is no value of the variable's type.
    #[error("is of type {kind}; `{text}` is no such value")]
    Text { kind: &'static str, text: String },
    /// A text with a NUL character.
    #[error("cannot take a text with a NUL character")]
    Nul,
    /// Not an input, where one is needed.
    #[error("is {0}, not an input")]
    NotInput(String),
    /// Not a parameter or a variable with a start value.
    #[error("is {0} and cannot be given a value before the start")]
    NotSettable(String),
    /// An element of an array without a signal.
    #[error("is an array, and the recording has no signal `{0}`; give one for each element")]
    NoSignal(String),
    /// The recorded signal's unit cannot be converted.
    #[error("is in `{own}`, but the signal is in `{other}`; the units do not convert")]
    Unit {
        /// The variable's unit.
        own: String,
        /// The signal's unit.
        other: String,
    },
}

/// What the integrator of a Model Exchange FMU found.
#[derive(Debug, thiserror::Error)]
pub enum IntegrationProblem {
    /// The solver's own error.
    #[error("{0}; loosen the tolerance or check the model")]
    Solver(#[from] ode_solvers::dop_shared::IntegrationError),
    /// A derivative that is not finite at the start of a step.
    #[error("a derivative is not finite")]
    NotFinite,
    /// Event iteration does not end.
    #[error("event iteration has not ended after {0} updates")]
    EventIteration(usize),
    /// Events accumulate at one time (Zeno behaviour, or an indicator that stays at zero).
    #[error("{0} events in a row with hardly any progress of time")]
    Zeno(usize),
}

/// What is wrong with an experiment.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExperimentProblem {
    /// Neither the caller nor the FMU says when to stop.
    #[error("no stop time: the FMU has no default experiment; give one")]
    NoStop,
    /// The stop time does not lie after the start.
    #[error("the stop time {stop} s does not lie after the start time {start} s")]
    Empty {
        /// Start, s.
        start: f64,
        /// Stop, s.
        stop: f64,
    },
    /// A step size that is not positive and finite.
    #[error("the step size {0} s is not positive and finite")]
    Step(f64),
    /// More steps than can be recorded.
    #[error(
        "{} steps are more than can be recorded; use a larger step size, or record fewer variables",
        rounded(*.0)
    )]
    TooLong(f64),
    /// The input recording has no sample.
    #[error("the input recording `{0}` has no sample")]
    EmptyInput(String),
    /// None of the recording's signals is an input of the FMU.
    #[error("no signal of `{recording}` is an input of the FMU, whose inputs are {inputs}")]
    NoInput {
        /// The recording's name.
        recording: String,
        /// The FMU's inputs.
        inputs: String,
    },
}
