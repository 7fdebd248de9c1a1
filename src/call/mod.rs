//! A command called from another program, as the Python wheel does, in place of a shell.
//!
//! A call has the arguments of the command line, so that options, defaults and messages exist once,
//! and its answer is what `--json` would have written. What differs is where things lie: recordings
//! may be handed over in memory, and what is written into the call's scratch folder is no file that
//! the user asked for: the answer does not name it, and recordings that would go there are handed
//! back.
//!
//! ```text
//!  caller ── Call::new(arguments, recordings) ──> run(), on a thread of its own ──> Answered
//!     └──── Watched: progress, stop ──────────────────┘                        or Refused
//! ```

pub mod campaign;
mod desk;
mod inputs;
#[cfg(test)]
mod tests;

use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use clap::Parser;
use drivescope_recording::{Recording, Report};

use crate::cli::Cli;
use crate::failure::{self, Ending};
use crate::session::Session;
use crate::{interrupt, panics};

pub(crate) use desk::Desk;
pub use desk::{Answered, Progress};
pub use inputs::{drive, drive_name, of_columns, page, read, reread, write};

/// A command that is to be run.
#[derive(Debug)]
pub struct Call {
    arguments: Vec<OsString>,
    desk: Arc<Desk>,
}

/// A call while it runs, for others than the thread that runs it.
#[derive(Debug, Clone)]
pub struct Watched(Arc<Desk>);

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refused {
    /// The input cannot be used: what the command line would say, and the next step.
    BadInput(String),
    /// The caller wanted it to end.
    Stopped,
    /// The program itself is wrong.
    Internal(String),
}

/// What the last panic said; a panic of a thread pool comes back without its place.
static SAID: Mutex<Option<String>> = Mutex::new(None);

/// How the command line is run by another process, as its words before the arguments, where this
/// process is not the program itself.
static PROGRAM: OnceLock<Vec<OsString>> = OnceLock::new();

/// Makes errors and panics of this process fit for a caller: nothing goes to standard error. To be
/// done once, before the first call. `program` are the words that run the command line.
pub fn install(program: Vec<OsString>) {
    let _ = PROGRAM.set(program);
    failure::install();
    panics::install_with(|line| {
        *SAID.lock().unwrap_or_else(PoisonError::into_inner) = Some(line);
    });
}

/// The command line as a process of its own, its arguments still to come.
///
/// # Errors
/// The system does not tell where this program is.
pub(crate) fn program() -> std::io::Result<Command> {
    match PROGRAM.get().map(Vec::as_slice) {
        Some([program, words @ ..]) => {
            let mut command = Command::new(program);
            command.args(words);
            Ok(command)
        }
        _ => std::env::current_exe().map(Command::new),
    }
}

/// Runs the command line in this process; the exit code.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    crate::ended(arguments).code()
}

/// Removes temporary files and folders of calls that never came to their end. To be done when the
/// process ends.
pub fn leave_nothing() {
    interrupt::leave_nothing();
}

impl Call {
    /// A command with its arguments, without the program's name. The recordings are found under
    /// their names wherever an argument names a recording; what is written into `scratch` is no
    /// file for the user.
    pub fn new(
        arguments: impl IntoIterator<Item = OsString>,
        recordings: impl IntoIterator<Item = (PathBuf, Recording, Report)>,
        scratch: &Path,
    ) -> Self {
        let program = [OsString::from("drivescope")];
        let arguments = program.into_iter().chain(arguments).collect();
        Self { arguments, desk: Arc::new(Desk::new(recordings, scratch)) }
    }

    /// The call, to be watched and stopped from elsewhere.
    pub fn watched(&self) -> Watched {
        Watched(Arc::clone(&self.desk))
    }

    /// Runs the command.
    ///
    /// # Errors
    /// [`Refused`]; a panic is caught, and is an internal error.
    pub fn run(self) -> Result<Answered, Refused> {
        let Self { arguments, desk } = self;
        interrupt::listen(&desk.stop);
        let cli = Cli::try_parse_from(arguments).map_err(|usage| {
            let said = usage.to_string();
            let said = said.strip_prefix("error: ").unwrap_or(&said);
            // How the command is typed into a shell is of no use here.
            Refused::BadInput(said.split("\n\nUsage:").next().unwrap_or(said).trim().to_owned())
        })?;
        let session = Session::of_call(&cli.common, Arc::clone(&desk));
        let ending = guarded(|| cli.command.run(&session))?;
        Ok(desk.answered(ending == Ending::Forbidden))
    }
}

impl Watched {
    /// What it does at the moment, if it says.
    pub fn progress(&self) -> Option<Progress> {
        self.0.progress()
    }

    /// Asks it to end; what it has not written by then is not written.
    pub fn stop(&self) {
        self.0.stop.store(true, Ordering::Relaxed);
    }
}

/// What the work comes to; a panic is an internal error.
fn guarded<T>(work: impl FnOnce() -> miette::Result<T>) -> Result<T, Refused> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(_)) if interrupt::check().is_err() => Err(Refused::Stopped),
        Ok(Err(report)) => Err(Refused::BadInput(in_words(&report))),
        Err(_) => {
            let said = SAID.lock().unwrap_or_else(PoisonError::into_inner).take();
            Err(Refused::Internal(said.unwrap_or_else(|| "internal error".to_owned())))
        }
    }
}

/// An error as the command line tells it, without the frame around it: what is wrong, and the next
/// step.
fn in_words(report: &miette::Report) -> String {
    match report.help() {
        Some(help) => format!("{report}\n{help}"),
        None => report.to_string(),
    }
}
