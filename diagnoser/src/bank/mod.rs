//! A bank of hypotheses about a physical process: which mechanism failed, since when, by how much.
//!
//! ```text
//! rows (C_m; T, I_m, u) --> Kalman filter over the Process --> whitened innovations
//!   --> likelihood ratios over mechanism and onset, stuck sensors, sum of squares --> alarm
//!   --> every mechanism at its likeliest size and onset --> name, confusion set, interval, unknown
//! ```
//!
//! Nothing here knows a drive: a [`Process`] says how its state moves and how each mechanism acts.
//! What its controller does with a faulty sensor needs no model, for the filter is conditioned on
//! the control effort that was recorded. [`learn`] makes a [`Watch`] of a process and a short
//! healthy run of one machine; no faulty recording is needed. [`calibrate`] designs the limits on
//! [`simulated`] machines and [`verify`] counts the alarms on others; a [`BankDesign`] is what a
//! diagnoser file holds.

mod baseline;
mod calibration;
mod columns;
mod design;
mod examine;
mod filter;
mod frozen;
mod growing;
mod hypothesis;
mod judge;
mod named;
mod onsets;
mod process;
mod separation;
mod simulated;
mod squares;
mod stored;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod watch;

pub use baseline::{BaselineError, FEWEST_ROWS, learn, log_likelihood};
pub use calibration::{Calibration, CalibrationError, Tails, Verified, calibrate, verify};
pub use design::{Tail, TailError};
pub use judge::{Candidate, Cause, Judgement, TWO_SIDED_95};
pub use process::{Advanced, Belief, MECHANISMS, Mechanism, Process, Row, SENSORS, Sensed};
pub use separation::{Separation, separation};
pub use simulated::{Driving, simulated};
pub use stored::{BankDesign, LearnedNoise};
pub use watch::{Alarm, Event, Limits, Statistics, Symptom, Watch};
