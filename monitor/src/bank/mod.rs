//! The drive as the process that a bank of hypotheses watches.
//!
//! ```text
//! Recording --> Columns --> rows of a bank
//! Drive, healthy rows --> design: noise --> process --> calibrate --> tails, limits
//! process, baseline --> AnyWatch, row by row
//! ```

mod design;
mod lanes;
mod mechanisms;
mod noise;
mod process;
mod rows;
mod sizes;

pub use design::{DesignError, Designed, design, design_for, usual_baseline};
pub use noise::{learn_noise, with_noise};
pub use process::ProcessError;
pub use rows::{CURRENTS, Columns, DRIVING, RowsError, without_current};
pub use sizes::{AnyProcess, AnyWatch, known_process, mechanisms, process};
