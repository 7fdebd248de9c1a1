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
//! healthy run of one machine; no faulty recording is needed.

mod baseline;
mod columns;
mod design;
mod examine;
mod filter;
mod frozen;
mod hypothesis;
mod judge;
mod onsets;
mod process;
mod separation;
mod squares;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod watch;

pub use baseline::{BaselineError, learn};
pub use design::{Tail, TailError};
pub use judge::{Candidate, Cause, Judgement};
pub use process::{Advanced, Belief, MECHANISMS, Mechanism, Process, Row, SENSORS, Sensed};
pub use separation::{Separation, separation};
pub use watch::{Alarm, Event, Limits, Statistics, Symptom, Watch};
