//! The drive and the diagnoser as FMI models.
//!
//! The program describes an FMU by them when it exports one, and the shared library inside the
//! FMU runs it; so the two cannot disagree. It is a crate of its own because the shared libraries
//! are built alone and cannot be linked by the program.

mod description;
mod diagnoser;
mod drive;
mod reference;
mod structure;

pub use diagnoser::{BASELINE_FILE, DIAGNOSER_FILE, DiagnoserError, DiagnoserModel, baseline_text};
pub use drive::{DRIVE_FILE, DriveError, DriveModel, OPEN_LOOP_FILE};
