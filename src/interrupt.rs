//! Ctrl-C and a request to terminate: the run ends, nothing stays half-written.
//!
//! Loops ask [`check`] and end the ordinary way, so that temporary files and folders go. Who does
//! not ask in time is ended here, but never while a file is being put in place.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{RwLock, RwLockReadGuard};
use std::time::Duration;

use crate::failure::Ending;

static ASKED: AtomicBool = AtomicBool::new(false);
/// Held for reading while a file is written under its temporary name and renamed.
static WRITING: RwLock<()> = RwLock::new(());
/// How long a loop may take to notice, and its temporary files to be removed.
const GRACE: Duration = Duration::from_millis(500);

/// The user wants the run to end.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("stopped; nothing was written")]
pub(crate) struct Stopped;

/// Listens for the signals.
pub(crate) fn install() {
    let stop = || {
        ASKED.store(true, Ordering::Relaxed);
        std::thread::sleep(GRACE);
        // A poisoned lock means that a write ended in a panic: it is over.
        let _written = WRITING.write();
        std::process::exit(Ending::Stopped.code().into());
    };
    // Without a handler (none can be set) the system's own way of ending applies.
    let _ = ctrlc::set_handler(stop);
}

/// Ends the run if the user wants that.
///
/// # Errors
/// [`Stopped`].
pub(crate) fn check() -> Result<(), Stopped> {
    if ASKED.load(Ordering::Relaxed) { Err(Stopped) } else { Ok(()) }
}

/// While this lives, the program is not ended from outside.
pub(crate) fn writing() -> Option<RwLockReadGuard<'static, ()>> {
    WRITING.read().ok()
}
