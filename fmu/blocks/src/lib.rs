//! The drive as an FMI model.
//!
//! The program describes an FMU by it when it exports one, and the shared library inside the
//! FMU runs it; so the two cannot disagree. It is a crate of its own because the shared library
//! is built alone and cannot be linked by the program.

mod description;
mod drive;
mod structure;

pub use drive::{DRIVE_FILE, DriveError, DriveModel, OPEN_LOOP_FILE};
