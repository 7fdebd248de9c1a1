//! The temporary folder of an unpacked archive. It goes with its last user; where the process is about
//! to end without dropping anything, [`remove_unpacked`] removes all there are.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::TempDir;

static FOLDERS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A folder that is removed when it is dropped.
#[derive(Debug)]
pub(crate) struct Unpacked(TempDir);

impl Unpacked {
    /// A new, empty one.
    pub(crate) fn new() -> io::Result<Unpacked> {
        let folder = tempfile::Builder::new().prefix("drivescope-fmu-").tempdir()?;
        FOLDERS.lock().unwrap_or_else(PoisonError::into_inner).push(folder.path().to_owned());
        Ok(Unpacked(folder))
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for Unpacked {
    fn drop(&mut self) {
        let mut folders = FOLDERS.lock().unwrap_or_else(PoisonError::into_inner);
        folders.retain(|folder| folder != self.0.path());
    }
}

/// Removes every folder that an FMU or a system is unpacked in: for the end of a process that drops
/// nothing any more. What is unpacked cannot be used after that.
pub fn remove_unpacked() {
    let mut folders = FOLDERS.lock().unwrap_or_else(PoisonError::into_inner);
    for folder in folders.drain(..) {
        // Nobody is left to be told of one that stays.
        let _ = std::fs::remove_dir_all(folder);
    }
}
