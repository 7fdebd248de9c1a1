//! The drive as the process that a bank of hypotheses watches, and what such a bank is worth.

mod lanes;
mod mechanisms;
mod process;

pub use process::{DriveProcess, ProcessError};
