//! A process that runs scenarios of a foreign FMU: how far it is, and whether it goes on.
//!
//! It adds a byte to a file after each scenario, in their order: what an FMU writes into the streams of
//! its process does not count.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus};
use std::time::{Duration, Instant};

use crate::interrupt::Asked;

/// How often it is looked whether a process has ended.
const LOOK: Duration = Duration::from_millis(5);

/// What the process says of itself.
pub(super) struct Progress(File);

impl Progress {
    /// Begins, for the process that makes that file of rows.
    ///
    /// # Errors
    /// It cannot be written.
    pub(super) fn begin(rows: &Path) -> std::io::Result<Self> {
        File::create(beside(rows)).map(Self)
    }

    /// One scenario more is over.
    pub(super) fn one_more(&self) {
        // Where that cannot be written, the rows cannot either, which says so.
        let _ = (&self.0).write_all(b".");
    }
}

fn beside(rows: &Path) -> PathBuf {
    rows.with_extension("progress")
}

/// How a process ended.
pub(super) enum Ended {
    /// By itself.
    Alone(ExitStatus),
    /// It was ended, because the scenario after so many took too long.
    TookTooLong { after: u64 },
}

/// Waits for a process that makes a file of the rows of so many scenarios, none of which may take longer
/// than the limit.
///
/// # Errors
/// The system does not tell of it, or (nothing) the user ends the run: the process is ended too.
pub(super) fn wait(
    child: &mut Child,
    (rows, scenarios): (&Path, u64),
    limit: Duration,
    asked: &Asked,
) -> std::io::Result<Option<Ended>> {
    let (progress, mut after, mut since) = (beside(rows), None, Instant::now());
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(Ended::Alone(status)));
        }
        let now = fs::metadata(&progress).map(|it| it.len()).ok();
        if now != after {
            (after, since) = (now, Instant::now());
        }
        // Before the first and after the last one no FMU is at work.
        let at = after.filter(|after| *after < scenarios && since.elapsed() > limit);
        if at.is_some() || asked.check().is_err() {
            child.kill()?;
            child.wait()?;
            return Ok(at.map(|after| Ended::TookTooLong { after }));
        }
        std::thread::sleep(LOOK);
    }
}
