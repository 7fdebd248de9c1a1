//! A diagnoser at work on one machine, row by row.
//!
//! ```text
//! Diagnoser, signals, baseline --> Monitor
//! row --> detectors of the residual, windows, bank over the drive's equations --> Happened
//! Monitor --> Finished: verdict and declarations of every method
//! ```
//!
//! Recordings, live rows, the page and the FMU of a diagnoser are watched by this code, so that
//! they decide alike. [`bank`] hands the equations of a drive to the bank as its process.

pub mod bank;
mod declaration;
mod detectors;
mod error;
mod feed;
mod found;
mod happened;
mod method;
mod monitor;
mod of_bank;
mod of_residual;
mod of_windows;
mod outside;
mod state;

pub use declaration::{Declaration, UNKNOWN};
pub use error::MonitorError;
pub use feed::{BRIDGED, Feed};
pub use found::{Declared, Fault, Finished, Found, Machine};
pub use happened::Happened;
pub use method::Method;
pub use monitor::{Baseline, Monitor, Options};
pub use of_bank::{Decision, STUCK};
pub use state::{Shown, Standing, State};
