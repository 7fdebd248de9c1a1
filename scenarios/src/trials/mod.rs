//! Trials of the bank of hypotheses: how often it is right on machines that it has never seen.
//!
//! ```text
//! healthy runs of two machines --> design --> limits          (one seed)
//! machines drawn anew: R, friction, noise --> closed loop, fault --> rows   (another seed)
//!   rows --> baseline learned --> watch --> alarms, names, sets, sizes --> Trials
//! ```
//!
//! The plant runs natively, which the FMU repeats bit for bit; the bank is handed the nominal drive
//! and signals, and no faulty run. A machine that its own baseline refuses counts as a miss wherever
//! it is counted. Every answer is held against the truth of another case as well: those figures, and
//! those of a detector that always alarms, must collapse.

mod along;
mod bench;
mod classes;
mod course;
mod delays;
mod detectable;
mod detectors;
mod healthy;
mod incipient;
mod isolation;
mod kept;
mod machine;
mod mechanisms;
#[cfg(test)]
mod rig_tests;
mod unknown;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use drivescope_diagnoser::DetectorError;
use drivescope_diagnoser::bank::TailError;
use drivescope_plant::drive::Drive;
use serde::Serialize;
use thiserror::Error;

use crate::experiment::ExperimentError;
use crate::study::Designed;
use bench::Bench;
use drivescope_monitor::bank::{DesignError, ProcessError};

pub use classes::{ClassRow, ClassTable, Classes};
pub use course::Course;
pub use delays::{Delay, DelayRow};
pub use detectable::{Detectable, HIDDEN_STEPS, HiddenEffect, ModelRows, hidden_effect};
pub use detectors::{Curves, DetectorRow, FaultDelays};
pub use healthy::{Healthy, HealthyRow};
pub use incipient::Incipient;
pub use isolation::{
    ClassifierRow, DesignRow, IsolationOptions, IsolationTrialError, IsolationTrials, isolation,
};
pub use mechanisms::{MechanismRow, Mechanisms, Sizes};
pub use unknown::{Unknown, UnknownRow};

/// Mean samples between false alarms that delays are compared at.
pub const ARL_0: [f64; 6] = [1e3, 1e4, 1e5, 1e6, 3e6, 1e7];

/// How much is tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialOptions {
    /// Machines of each row.
    pub machines: usize,
    /// Healthy samples that false alarms are counted on.
    pub healthy: usize,
    /// Mean samples between false alarms that the bank is designed for.
    pub arl_0: f64,
    /// Seed of the design; the machines that are judged have others.
    pub seed: u64,
}

/// Why there are no trials.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrialError {
    /// The drive has no sampled controller.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// No bank is designed.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// No process is made of a machine.
    #[error(transparent)]
    Process(#[from] ProcessError),
    /// Too few healthy samples for a limit.
    #[error(transparent)]
    Tail(#[from] TailError),
    /// A sample that a detector of the paper cannot judge.
    #[error(transparent)]
    Detector(#[from] DetectorError),
    /// The drive lacks the effect that was to be hidden.
    #[error("the drive has no effect {effect} that a model could lack")]
    NoEffect {
        /// Its identifier.
        effect: String,
    },
    /// The recordings cannot be written.
    #[error("{} cannot be written to: {kind}", folder.display())]
    Unwritable {
        folder: PathBuf,
        /// What the system says.
        kind: ErrorKind,
    },
    /// Whoever watched it ended it.
    #[error("the trials were stopped")]
    Stopped,
}

/// What came of the trials.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trials {
    pub design_seed: u64,
    /// Seed of the machines that were judged.
    pub judged_seed: u64,
    /// Designed mean samples between false alarms.
    pub arl_0: f64,
    /// Samples that a judgement rests on, and a baseline.
    pub horizon: usize,
    /// Samples of a baseline.
    pub baseline: usize,
    /// The twelve faults, with the current and without.
    pub classes: Classes,
    /// Ten mechanisms of random size at three set points.
    pub mechanisms: Mechanisms,
    /// Delays beside those of a detector that knows machine and mechanism.
    pub delays: Vec<DelayRow>,
    /// Faults that grow.
    pub incipient: Vec<Incipient>,
    /// Kinds that the bank does not hold.
    pub unknown: Unknown,
    /// False alarms.
    pub healthy: Healthy,
}

/// Steps of [`detectors`], for a progress bar: the bank's delays, its false alarms, and the others.
pub fn detector_steps() -> u64 {
    2 + detectors::compared().count() as u64
}

/// Delays of all detectors at equal mean times between false alarms: of the bank of a drive, of the
/// detectors that a study designed for it, and of one that knows machine and mechanism; the recordings
/// are kept in a folder where one is named, for detectors of other people. Ends where `advance`, called after each detector, answers true.
///
/// # Errors
/// [`TrialError`], which says what did not suit.
pub fn detectors(
    drive: Drive,
    designed: &Designed,
    options: &TrialOptions,
    keep: Option<&Path>,
    advance: &(dyn Fn() -> bool + Sync),
) -> Result<Curves, TrialError> {
    let bench = Bench::new(drive, options)?;
    if let Some(folder) = keep {
        let unwritable = |source: std::io::Error| TrialError::Unwritable {
            folder: folder.to_owned(),
            kind: source.kind(),
        };
        kept::keep(&bench, folder).map_err(unwritable)?;
    }
    let step = || if advance() { Err(TrialError::Stopped) } else { Ok(()) };
    detectors::curves(&bench, designed, options.healthy, &step)
}

/// Steps of [`trials`], for a progress bar.
pub const STEPS: u64 = 6;

/// Designs the bank of a drive and tries it; ends where `advance`, called after each step, answers
/// true.
///
/// # Errors
/// [`TrialError`], which says what did not suit.
pub fn trials(
    drive: Drive,
    options: &TrialOptions,
    advance: &(dyn Fn() -> bool + Sync),
) -> Result<Trials, TrialError> {
    let bench = Bench::new(drive, options)?;
    let step = || if advance() { Err(TrialError::Stopped) } else { Ok(()) };
    let classes = classes::classes(&bench);
    step()?;
    let mechanisms = mechanisms::mechanisms(&bench);
    step()?;
    let delays = delays::delays(&bench)?;
    step()?;
    let incipient = incipient::incipient(&bench);
    step()?;
    let unknown = unknown::unknown(&bench)?;
    step()?;
    let healthy = healthy::healthy(&bench, options.healthy);
    step()?;
    Ok(Trials {
        design_seed: options.seed,
        judged_seed: bench.judged_seed,
        arl_0: options.arl_0,
        horizon: bench.designed.how.horizon,
        baseline: bench.designed.how.baseline,
        classes,
        mechanisms,
        delays,
        incipient,
        unknown,
        healthy,
    })
}
