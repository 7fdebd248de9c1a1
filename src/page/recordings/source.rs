//! Where a recording lies, and where what was said of it is kept.

use std::path::{Path, PathBuf};

use drivescope_recording::ReadOptions;
use tempfile::TempPath;

/// Where a recording lies.
#[derive(Debug)]
pub(super) enum Source {
    /// A file of this server, removed with the recording.
    Own(TempPath),
    /// A file that the command line named.
    Given(PathBuf),
    /// None: it was simulated.
    Made,
}

impl Source {
    /// Its file.
    pub(super) fn path(&self) -> Option<&Path> {
        match self {
            Self::Own(path) => Some(path),
            Self::Given(path) => Some(path),
            Self::Made => None,
        }
    }
}

/// Keeps what was said beside the file; where, or why not.
pub(super) fn keep(options: &ReadOptions, path: &Path) -> String {
    match options.keep(path) {
        Ok(_) => format!("Kept in {} for later.", shown_place(path)),
        Err(error) => format!("Not kept for later: {error}."),
    }
}

/// The file beside it in which that is kept, as it is shown.
pub(super) fn shown_place(path: &Path) -> String {
    let kept = ReadOptions::kept_at(path);
    kept.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
