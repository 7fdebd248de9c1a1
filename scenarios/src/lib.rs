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
//!
//! ```
//! use std::path::Path;
//!
//! use drivescope_scenarios::campaign::Plan;
//!
//! let text = r#"
//! schema = 1
//! name = "tachometer"
//! drive = "dr300"
//! seed = 1
//! draws = 5
//! duration = 20.0  # s
//! [[fault]]
//! kind = "tacho"
//! size = { grid = [0.05, 0.1] }
//! onset = { uniform = [12.0, 15.0] }  # s
//! [detector]
//! methods = ["constant"]
//! "#;
//! let plan = Plan::parse(text, "plan.toml", Path::new(""))?;
//! assert_eq!(plan.scenarios(), 10);
//! // A function of plan and number, whatever ran before.
//! assert_eq!(plan.scenario(3).faults, plan.scenario(3).faults);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
