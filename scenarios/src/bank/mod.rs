//! The drive as the process that a bank of hypotheses watches.
//!
//! ```text
//! Recording --> Columns --> rows of a bank
//! Drive, healthy rows --> learn_noise --> process --> calibrate, verify --> limits
//! process, baseline --> AnyWatch, row by row
//! ```

mod lanes;
mod mechanisms;
mod noise;
mod process;
mod rows;
mod sizes;

pub use noise::{learn_noise, with_noise};
pub use process::{DriveProcess, ProcessError};
pub use rows::{Columns, RowsError, without_current};
pub use sizes::{AnyProcess, AnyWatch, process};
#[cfg(test)]
mod tests;
