//! Errors of the program itself, how errors look, and how a run ends.

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use miette::{Diagnostic, MietteHandlerOpts, Report};
use thiserror::Error;

/// How a run ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// The command did what was asked.
    Done,
    /// The answer is a finding that `--check` forbids.
    Forbidden,
    /// The input cannot be used, or an output cannot be written.
    BadInput,
    /// The user stopped it.
    Stopped,
    /// The program itself is wrong.
    Internal,
}

impl Ending {
    /// The exit code.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Forbidden => 1,
            Self::BadInput => 2,
            // As a shell counts a process ended by SIGINT.
            Self::Stopped => 130,
            // EX_SOFTWARE of sysexits.h.
            Self::Internal => 70,
        }
    }
}

impl From<Ending> for ExitCode {
    fn from(ending: Ending) -> Self {
        ending.code().into()
    }
}

/// The user wants the run to end.
#[derive(Debug, Error, Diagnostic)]
#[error("stopped; nothing was written")]
pub(crate) struct Stopped;

/// The same where something was kept.
#[derive(Debug, Error, Diagnostic)]
#[error("stopped; {kept}")]
pub(crate) struct StoppedPartWay {
    /// What was, and how to go on.
    pub(crate) kept: String,
}

/// What the program itself finds wrong.
#[derive(Debug, Error, Diagnostic)]
pub(crate) enum Failure {
    /// A file cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    #[diagnostic(help("choose a file in a folder that exists and that you may write to"))]
    Write {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// It was stopped before something was written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Stopped(#[from] Stopped),
    /// Standard output cannot be written to.
    #[error("standard output cannot be written to: {source}")]
    Print {
        /// Why not.
        source: io::Error,
    },
    /// Nobody can listen at that port.
    #[error("port {port} of this machine cannot be served: {source}")]
    #[diagnostic(help("choose another --port, or leave it out for any that is free"))]
    Serve {
        port: u16,
        /// Why not.
        source: io::Error,
    },
    /// A file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// Who reads standard output has gone away.
    #[error("nobody reads standard output any more")]
    Unread,
    /// Neither a file nor a built-in drive.
    #[error("`{name}` is neither a file nor a built-in drive")]
    #[diagnostic(help("built-in drives: {known}"))]
    UnknownDrive {
        /// What was given.
        name: String,
        /// The built-in drives.
        known: String,
    },
    /// An effect that the library does not have.
    #[error("there is no effect `{id}`")]
    #[diagnostic(help("the library has {known}"))]
    UnknownEffect {
        /// What was given.
        id: String,
        /// The effects.
        known: String,
    },
    /// No FMU can be for this platform.
    #[error("FMI has no name for this platform, so nothing could load the FMU")]
    #[diagnostic(help("export on Linux or macOS (x86_64 or aarch64), or on Windows (x86_64)"))]
    Platform,
    /// Two things that exclude each other, or one that needs another.
    #[error("{what}")]
    #[diagnostic(help("{instead}"))]
    Usage {
        /// What does not fit.
        what: String,
        /// What to do instead.
        instead: String,
    },
}

/// An error of a library as a report: its message, and of its causes what the message does not
/// say already.
pub(crate) fn into_report(error: impl std::error::Error) -> Report {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        let said = inner.to_string();
        if !text.contains(&said) {
            text = format!("{text}: {said}");
        }
        cause = inner.source();
    }
    Report::msg(text)
}

/// The place of an error in a text where a person could see it there: not in a line longer than any
/// screen (and the renderer cannot pad beyond 65,535 columns).
pub(crate) fn visible(text: &str, place: std::ops::Range<usize>) -> Option<miette::SourceSpan> {
    const LONGEST_LINE: usize = 1000;
    let (start, end) = (place.start.min(text.len()), place.end.min(text.len()));
    let before = text.as_bytes()[..start].iter().rev().take_while(|byte| **byte != b'\n').count();
    let after = text.as_bytes()[end..].iter().take_while(|byte| **byte != b'\n').count();
    (before + (end - start) + after <= LONGEST_LINE).then(|| (start..end).into())
}

/// Makes errors look the same on every terminal: no line is broken inside a path.
pub(crate) fn install() {
    // Fails only where a hook is set already, as in tests that share a process.
    let _ = miette::set_hook(Box::new(|_| {
        Box::new(
            MietteHandlerOpts::new()
                .wrap_lines(false)
                .break_words(false)
                .without_cause_chain()
                .build(),
        )
    }));
}

/// Shows the error on standard error; how the run ends with it.
pub(crate) fn report(error: &Report) -> Ending {
    use io::Write;

    let failure = error.downcast_ref::<Failure>();
    if matches!(failure, Some(Failure::Unread)) {
        return Ending::Done;
    }
    let is_stopped = matches!(failure, Some(Failure::Stopped(_)));
    if is_stopped || error.is::<Stopped>() || error.is::<StoppedPartWay>() {
        let _ = writeln!(io::stderr(), "drivescope: {error}");
        return Ending::Stopped;
    }
    let _ = writeln!(io::stderr(), "{error:?}");
    Ending::BadInput
}
