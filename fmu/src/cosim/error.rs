//! What can go wrong with a system. Errors name the component and, once it runs, the time.

use std::path::PathBuf;

use drivescope_recording::rounded;

use crate::import;

use super::component::{Failure, PortKind};
use crate::position::DocumentProblem;

/// What a reader of recordings may fail with.
pub type ReadError = Box<dyn std::error::Error + Send + Sync>;

/// An error of a system.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A name that is taken.
    #[error("component `{name}` exists twice; names must be unique")]
    Twice { name: String },
    /// No such component.
    #[error("there is no component `{name}` (in `{path}`); there are: {}", there.join(", "))]
    NoComponent {
        name: String,
        /// The whole port path.
        path: String,
        /// The components there are.
        there: Vec<String>,
    },
    /// No such input or output.
    #[error("component `{component}` has no {what} `{port}`{}", near.as_ref().map_or(String::new(), |near| format!("; did you mean `{near}`?")))]
    NoPort {
        component: String,
        /// `input` or `output`.
        what: &'static str,
        port: String,
        /// The most similar name there is.
        near: Option<String>,
    },
    /// An input or output that is no scalar number.
    #[error("`{component}.{port}` is {what}: only scalar numbers are connected and recorded")]
    NotScalar { component: String, port: String, what: String },
    /// Not `component.port`.
    #[error("`{path}` is no port; write `component.port`")]
    NoPath {
        /// What was written.
        path: String,
    },
    /// An input with two sources.
    #[error("input `{input}` has two sources, `{first}` and `{second}`; connect one")]
    TwoSources {
        input: String,
        first: String,
        /// Its other source.
        second: String,
    },
    /// Values of different kinds.
    #[error(
        "`{from}` ({from_kind:?}) cannot drive `{to}` ({to_kind:?}); connect ports of one type"
    )]
    Kind { from: String, from_kind: PortKind, to: String, to_kind: PortKind },
    /// Units that do not convert.
    #[error(
        "`{from}` is in `{from_unit}`, `{to}` in `{to_unit}`, and these do not convert; connect ports of one quantity, or define the units in the FMU"
    )]
    Unit { from: String, from_unit: String, to: String, to_unit: String },
    /// A recording without the signal.
    #[error("recording `{recording}` has no signal `{signal}`; it has: {}", there.join(", "))]
    NoSignal {
        recording: String,
        signal: String,
        /// The signals there are.
        there: Vec<String>,
    },
    /// A recording without samples.
    #[error("recording `{recording}` has no sample; give one that covers the experiment")]
    EmptyRecording { recording: String },
    /// Something that cannot be recorded.
    #[error("`{path}` is a connected input; record the output that drives it, `{source_path}`")]
    RecordInput {
        path: String,
        /// What drives it.
        source_path: String,
    },
    /// An experiment that cannot be run.
    #[error("the experiment cannot be run: {problem}")]
    Experiment {
        /// What is wrong with it.
        problem: import::ExperimentProblem,
    },
    /// An order that does not name each component once.
    #[error("the order must name each component once; `{name}` is {problem}")]
    Order {
        name: String,
        /// `missing`, `unknown` or `named twice`.
        problem: &'static str,
    },
    /// An algebraic loop without a solution by iteration.
    #[error("the algebraic loop {} has not settled after {passes} passes (last change {change:e}); break it with a delay, or check the gains", cycle.join(" -> "))]
    AlgebraicLoop {
        /// The ports of the loop.
        cycle: Vec<String>,
        /// Passes that were made.
        passes: usize,
        /// The largest relative change in the last pass.
        change: f64,
    },
    /// Rolling back was asked for, but a component cannot save its state.
    #[error(
        "component `{component}` cannot save its state, so steps cannot be rolled back; switch `rollback` off"
    )]
    NoRollback { component: String },
    /// A component failed.
    #[error("component `{component}` failed at {} s: {failure}", rounded(*time))]
    Component {
        component: String,
        /// Simulation time, s.
        time: f64,
        failure: Failure,
    },
    /// A file that cannot be read.
    #[error("{}: cannot be read ({source})", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// A system description that is wrong at one place.
    #[error("{}:{}:{}: {}", path.display(), problem.position.line, problem.position.column, problem.text)]
    Document { path: PathBuf, problem: DocumentProblem },
    /// An FMU of the system cannot be used.
    #[error("component `{component}`: {source}")]
    Fmu { component: String, source: Box<import::Error> },
    /// A recording of the system cannot be read.
    #[error("recording `{}`: {source}", path.display())]
    Recording { path: PathBuf, source: ReadError },
    /// A file name that no system description has.
    #[error("{}: not a system description; give a .toml, .ssd or .ssp file", path.display())]
    FileKind { path: PathBuf },
}
