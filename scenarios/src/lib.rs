//! When which fault happens, and what came of it.
//!
//! ```text
//! drive file -> Experiment -> inputs of a run (reference, noise, fault) as a Recording
//!   -> native run (Sampled)            -> Recording  -> how far the FMU agrees
//!   -> FMU through the co-simulation algorithm -> Recording and a diagnoser's verdicts
//!   -> study: train, design, judge twelve faults  -> StudyResults
//!   -> campaign: many scenarios of a plan, a row each
//!   -> parity: one design, judged over many draws of the noise -> Parity
//! ```
//!
//! Randomness is drawn before anything runs in parallel: a run's inputs are a function of the
//! seed and the run's number.

pub mod campaign;
pub mod cosimulated;
pub mod drives;
pub mod experiment;
pub mod faults;
pub mod native;
pub mod parity;
pub mod profile;
pub mod results;
mod seen;
mod shares;
pub mod study;
pub mod trials;
