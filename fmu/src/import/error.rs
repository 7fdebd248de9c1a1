//! What can go wrong with an FMU of another tool. Every error names the FMU's file and, where there
//! is one, the place in it, the value found and what to do next.

use std::fmt;
use std::path::PathBuf;

use drivescope_recording::rounded;

use super::description::Interface;
use super::logging::Message;
use super::problem::{ExperimentProblem, IntegrationProblem, UnsafeEntry, VariableProblem};
use super::status::Status;
use crate::position::DocumentProblem;

/// An error while an FMU is opened, instantiated or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be opened.
    #[error("{fmu}: cannot open the file ({source}); check the path and its permissions")]
    Open { fmu: String, source: std::io::Error },
    /// The file is no zip archive, or its directory is damaged.
    #[error("{fmu}: not a readable zip archive ({source}); export or download the FMU again")]
    Archive {
        /// The FMU's file name.
        fmu: String,
        /// What the archive reader found.
        source: zip::result::ZipError,
    },
    /// One entry of the archive is damaged or packed in a way that is not supported.
    #[error(
        "{fmu}: entry `{entry}` cannot be unpacked ({source}); export or download the FMU again"
    )]
    Entry {
        /// The FMU's file name.
        fmu: String,
        /// The entry's name, or its number when the name itself is damaged.
        entry: String,
        /// What the archive reader found.
        source: zip::result::ZipError,
    },
    /// An entry whose name or kind could write outside the FMU's own folder.
    #[error("{fmu}: entry `{entry}` {problem}; the FMU was not unpacked, do not use it")]
    Unsafe {
        /// The FMU's file name.
        fmu: String,
        /// The entry's name.
        entry: String,
        /// What is wrong with it.
        problem: UnsafeEntry,
    },
    /// Unpacking would take more room than an FMU may.
    #[error("{fmu}: unpacks to more than {limit} {unit} at entry `{entry}`; it may be a zip bomb")]
    TooLarge {
        /// The FMU's file name.
        fmu: String,
        /// The entry at which the limit was passed.
        entry: String,
        limit: u64,
        /// What the limit counts (`bytes`, `entries`).
        unit: &'static str,
    },
    /// Unpacking could not write into the temporary folder.
    #[error("{fmu}: cannot write {} ({source}); free some room in the temporary folder", path.display())]
    Unpack {
        /// The FMU's file name.
        fmu: String,
        /// The file that could not be written.
        path: PathBuf,
        source: std::io::Error,
    },
    /// `modelDescription.xml` is missing.
    #[error("{fmu}: the archive has no modelDescription.xml at its top; it is not an FMU")]
    NoDescription {
        /// The FMU's file name.
        fmu: String,
    },
    /// `modelDescription.xml` is malformed or lacks what is needed to run the FMU.
    #[error("{fmu}: {0}; ask the exporting tool's maker", place.in_file("modelDescription.xml"))]
    Description {
        /// The FMU's file name.
        fmu: String,
        place: Box<DocumentProblem>,
    },
    /// An FMI version other than 2.0 and 3.x.
    #[error("{fmu}: FMI version `{version}` is not supported; export the model as FMI 2.0 or 3.0")]
    Version {
        /// The FMU's file name.
        fmu: String,
        /// The version that `modelDescription.xml` states.
        version: String,
    },
    /// No binary for this platform.
    #[error(
        "{fmu}: no binary for this platform ({platform}: {missing} is missing); it has {}; \
         export the FMU on this platform",
        list(has, "no binaries at all")
    )]
    Platform {
        /// The FMU's file name.
        fmu: String,
        /// This platform, as the FMU's FMI version calls it.
        platform: &'static str,
        /// The file that was looked for.
        missing: String,
        /// The platforms that the FMU has binaries for.
        has: Vec<String>,
    },
    /// The binary could not be loaded.
    #[error(
        "{fmu}: its binary cannot be loaded ({}); install what it depends on",
        loader_says(source)
    )]
    Load {
        /// The FMU's file name.
        fmu: String,
        /// What the dynamic linker found.
        source: libloading::Error,
    },
    /// The binary expects the host to be a Python process, and no Python library could be found.
    #[error(
        "{fmu}: its binary needs the Python library ({reason}); set DRIVESCOPE_PYTHON to a Python \
         that was built with a shared library, or DRIVESCOPE_LIBPYTHON to that library"
    )]
    Python {
        /// The FMU's file name.
        fmu: String,
        /// Why none could be loaded.
        reason: String,
    },
    /// The binary lacks functions without which it cannot run.
    #[error("{fmu}: its binary lacks {}; export the FMU again with a complete tool", missing.join(", "))]
    Symbols {
        /// The FMU's file name.
        fmu: String,
        /// The missing functions.
        missing: Vec<String>,
    },
    /// The FMU does not offer the interface type that was asked for.
    #[error(
        "{fmu}: offers no {wanted}; it offers {}",
        list(has, "neither Co-Simulation nor Model Exchange")
    )]
    NoInterface {
        /// The FMU's file name.
        fmu: String,
        /// What was asked for.
        wanted: Interface,
        /// What there is.
        has: Vec<String>,
    },
    /// A second instance of an FMU that allows one in a process.
    #[error(
        "{fmu}: can be instantiated only once in a process; drop the first instance, or run several processes"
    )]
    OnlyOnce {
        /// The FMU's file name.
        fmu: String,
    },
    /// The FMU refused to make an instance.
    #[error("{fmu}: refused to make instance `{instance}`{}", said(messages))]
    Instantiate {
        /// The FMU's file name.
        fmu: String,
        /// The instance's name.
        instance: String,
        /// What the FMU logged.
        messages: Vec<Message>,
    },
    /// No variable of that name.
    #[error("{fmu}: has no variable `{name}`{}", did_you_mean(near))]
    UnknownVariable {
        /// The FMU's file name.
        fmu: String,
        /// The name that was asked for.
        name: String,
        /// The most similar name there is.
        near: Option<String>,
    },
    /// A variable that cannot be used as asked.
    #[error("{fmu}: variable `{name}` {problem}")]
    Variable {
        /// The FMU's file name.
        fmu: String,
        name: String,
        /// Why it cannot.
        problem: VariableProblem,
    },
    /// The numbers of references and values differ.
    #[error("{fmu}: {references} value references, but {values} values")]
    Lengths {
        /// The FMU's file name.
        fmu: String,
        /// Number of value references.
        references: usize,
        /// Number of values.
        values: usize,
    },
    /// A call in the wrong order.
    #[error("{fmu}: `{call}` is not allowed while instance `{instance}` is {mode}")]
    Order {
        /// The FMU's file name.
        fmu: String,
        /// The instance's name.
        instance: String,
        /// What was called.
        call: &'static str,
        /// What state the instance is in.
        mode: &'static str,
    },
    /// An FMI function returned an error.
    #[error(
        "{fmu}: {function} of `{instance}` returned {status} at time {} s{}",
        rounded(*time),
        said(messages)
    )]
    Call {
        /// The FMU's file name.
        fmu: String,
        /// The instance's name.
        instance: String,
        /// The FMI function, with the variable where it is about one.
        function: String,
        /// What it returned.
        status: Status,
        /// Simulation time, s.
        time: f64,
        /// What the FMU logged.
        messages: Vec<Message>,
    },
    /// A communication step that the FMU could not complete.
    #[error(
        "{fmu}: `{instance}` discarded the step from {} s to {} s (it reached {} s){}; \
         use a smaller communication step size",
        rounded(*time),
        rounded(*target),
        rounded(*reached),
        said(messages)
    )]
    Discard {
        /// The FMU's file name.
        fmu: String,
        /// The instance's name.
        instance: String,
        /// Start of the step, s.
        time: f64,
        /// End of the step, s.
        target: f64,
        /// The last time that was computed successfully, s.
        reached: f64,
        /// What the FMU logged.
        messages: Vec<Message>,
    },
    /// The FMU lacks an optional capability.
    #[error("{fmu}: {capability} is not supported by this FMU")]
    Capability {
        /// The FMU's file name.
        fmu: String,
        /// What was asked for.
        capability: &'static str,
    },
    /// An FMU state of another instance.
    #[error("{fmu}: this FMU state was taken from another instance; serialise it there instead")]
    ForeignState {
        /// The FMU's file name.
        fmu: String,
    },
    /// Bytes that are no saved state of this FMU.
    #[error("{fmu}: these bytes are no saved state of this FMU and interface type")]
    StateBytes {
        /// The FMU's file name.
        fmu: String,
    },
    /// The integration of a Model Exchange FMU failed.
    #[error("{fmu}: integration of `{instance}` failed at {} s ({problem})", rounded(*time))]
    Integration {
        /// The FMU's file name.
        fmu: String,
        /// The instance's name.
        instance: String,
        /// Where, s.
        time: f64,
        /// What the solver found.
        problem: IntegrationProblem,
    },
    /// An experiment that cannot be run.
    #[error("{fmu}: {problem}")]
    Experiment {
        /// The FMU's file name.
        fmu: String,
        /// What is wrong with it.
        problem: ExperimentProblem,
    },
}

fn list(items: &[String], none: &str) -> String {
    if items.is_empty() { none.to_owned() } else { items.join(", ") }
}

fn did_you_mean(near: &Option<String>) -> String {
    near.as_ref().map_or(String::new(), |name| format!("; did you mean `{name}`?"))
}

/// The last few messages: the ones before the failure are the ones that explain it. Where some tell of
/// something wrong, those alone.
fn said(messages: &[Message]) -> impl fmt::Display {
    const SHOWN: usize = 3;
    let wrong: Vec<&Message> =
        messages.iter().filter(|message| message.status != Status::Ok).collect();
    let shown = if wrong.is_empty() { messages.iter().collect() } else { wrong };
    let first = shown.len().saturating_sub(SHOWN);
    shown[first..].iter().fold(String::new(), |text, message| text + "; it says: " + &message.text)
}

/// The dynamic linker's own words, which the loading crate keeps as the source of its error.
pub(super) fn loader_says(error: &libloading::Error) -> String {
    std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string)
}
