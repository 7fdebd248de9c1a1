//! Ctrl-C and a request to terminate: the run ends, nothing stays half-written.
//!
//! Loops ask [`check`] and end the ordinary way, so that temporary files and folders go. Who does
//! not ask in time is ended here, but never while a file is being put in place.
//!
//! A command that another program called ends when that program wants it to: its thread
//! [listens](listen) to that call alone.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock, RwLockReadGuard};
use std::time::Duration;

use crate::failure::{Ending, Stopped};

static ASKED: AtomicBool = AtomicBool::new(false);
/// Set where a run answers with what it has when it is to end.
static ANSWERS: AtomicBool = AtomicBool::new(false);
/// Held for reading while a file is written under its temporary name and renamed.
static WRITING: RwLock<()> = RwLock::new(());
/// Files and folders of the run that are no result, in the order in which they were made.
static LEFTOVERS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// How names of temporary folders begin.
pub(crate) const OWN: &str = ".drivescope-";
/// How long a loop may take to notice, and its temporary files to be removed.
const GRACE: Duration = Duration::from_millis(500);

/// Listens for the signals.
pub(crate) fn install() {
    let stop = || {
        let is_first = !ASKED.swap(true, Ordering::Relaxed);
        std::thread::sleep(GRACE);
        if is_first && ANSWERS.load(Ordering::Relaxed) {
            return;
        }
        // A poisoned lock means that a write ended in a panic: it is over.
        let _written = WRITING.write();
        leave_nothing();
        std::process::exit(Ending::Stopped.code().into());
    };
    // Without a handler (none can be set) the system's own way of ending applies.
    let _ = ctrlc::set_handler(stop);
}

/// Removes what a run that was not ended the ordinary way would leave.
pub(crate) fn leave_nothing() {
    drivescope_fmu::import::remove_unpacked();
    let mut leftovers = LEFTOVERS.lock().unwrap_or_else(PoisonError::into_inner);
    for path in leftovers.drain(..).rev() {
        // Nobody is left to be told of what stays; a folder with other files in it does.
        let _ =
            std::fs::remove_file(&path).or_else(|_| match path.file_name().is_some_and(is_own) {
                true => std::fs::remove_dir_all(&path),
                false => std::fs::remove_dir(&path),
            });
    }
}

/// Whether a name is that of a temporary folder of this program.
fn is_own(name: &std::ffi::OsStr) -> bool {
    name.to_string_lossy().starts_with(OWN)
}

/// A path that is to vanish if the run is ended from outside.
#[derive(Debug)]
pub(crate) struct Leftover(PathBuf);

impl Leftover {
    /// Watches that path from now on.
    pub(crate) fn new(path: &Path) -> Self {
        LEFTOVERS.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Leftover {
    fn drop(&mut self) {
        LEFTOVERS.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| *path != self.0);
    }
}

thread_local! {
    static CALL: RefCell<Asked> = RefCell::default();
}

/// Who may ask a run to end: the signals, and the call that it belongs to. Closures that other
/// threads run take it along.
#[derive(Debug, Clone, Default)]
pub(crate) struct Asked(Option<Arc<AtomicBool>>);

impl Asked {
    /// Ends the run if the user wants that.
    ///
    /// # Errors
    /// [`Stopped`].
    pub(crate) fn check(&self) -> Result<(), Stopped> {
        let called = self.0.as_ref().is_some_and(|call| call.load(Ordering::Relaxed));
        if called || ASKED.load(Ordering::Relaxed) { Err(Stopped) } else { Ok(()) }
    }
}

/// Whom the run of this thread listens to.
pub(crate) fn asked() -> Asked {
    CALL.with_borrow(Clone::clone)
}

/// From now on the run of this thread ends when that flag is set, too.
pub(crate) fn listen(call: &Arc<AtomicBool>) {
    CALL.set(Asked(Some(Arc::clone(call))));
}

/// Ends the run of this thread if the user wants that.
///
/// # Errors
/// [`Stopped`].
pub(crate) fn check() -> Result<(), Stopped> {
    CALL.with_borrow(Asked::check)
}

/// From now on the run notices by itself that it is to end, and answers with what it has; who asks
/// twice ends it.
pub(crate) fn answers() {
    ANSWERS.store(true, Ordering::Relaxed);
}

/// Whether what the run has made may still be written.
pub(crate) fn may_write() -> bool {
    ANSWERS.load(Ordering::Relaxed) || check().is_ok()
}

/// While this lives, the program is not ended from outside.
pub(crate) fn writing() -> Option<RwLockReadGuard<'static, ()>> {
    WRITING.read().ok()
}
