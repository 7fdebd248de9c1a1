//! A bank designed on healthy rows: noise learned, tails of its statistics on simulated machines.

use drivescope_diagnoser::bank::{
    Calibration, CalibrationError, Driving, LearnedNoise, Row, Tails,
};
use drivescope_plant::drive::Drive;
use thiserror::Error;

use super::noise::{learn_noise, with_noise};
use super::process::ProcessError;
use super::sizes::{AnyProcess, process};

/// Time that a machine is learned from, s, and fewest rows.
const BASELINE_S: f64 = 5.0;
const FEWEST_BASELINE: usize = 200;
/// Time that a judgement rests on, s, and fewest rows.
const HORIZON_S: f64 = 0.5;
const FEWEST_HORIZON: usize = 40;
/// Healthy samples that limits are designed on.
const DESIGNED: usize = 600_000;

/// Why no bank is designed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DesignError {
    /// No process is made of the drive.
    #[error(transparent)]
    Process(#[from] ProcessError),
    /// There are no limits.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    #[error("the healthy recordings show nothing that drives: record C_m or u")]
    NothingDrives,
}

/// A bank before its limits are chosen.
pub struct Designed {
    /// Noise that was learned.
    pub noise: LearnedNoise,
    /// The drive with that noise.
    pub drive: Drive,
    /// The drive as the process that is watched.
    pub process: Box<dyn AnyProcess>,
    /// Tails with the signals of the rows.
    pub tails: Tails,
    /// Tails without the current, where it is among them.
    pub tails_without_current: Option<Tails>,
    /// How the machines were drawn, for a verification on others.
    pub how: Calibration,
}

/// Rows that a machine sampled every `period_s` is learned from, where nothing is said.
pub fn usual_baseline(period_s: f64) -> usize {
    samples(BASELINE_S, period_s, FEWEST_BASELINE)
}

fn samples(time_s: f64, period_s: f64, least: usize) -> usize {
    ((time_s / period_s).round() as usize).max(least)
}

/// Designs the bank of a drive on healthy runs, sampled every `period_s`, with and without the current.
///
/// # Errors
/// [`DesignError`], which says what did not suit.
pub fn design(
    drive: &Drive,
    period_s: f64,
    healthy: &[Vec<Row>],
    seed: u64,
) -> Result<Designed, DesignError> {
    let designed = design_for(drive, period_s, healthy, (usual_baseline(period_s), seed))?;
    let Designed { how, ref process, .. } = designed;
    let mut blind = how.driving;
    blind.measured[1] = false;
    let tails_without_current = (how.driving.measured[0] && how.driving.measured[1])
        .then(|| process.calibrate(&Calibration { driving: blind, ..how }))
        .transpose()?;
    Ok(Designed { tails_without_current, ..designed })
}

/// The same for the signals of the healthy runs alone, each machine to be learned from `baseline` rows.
///
/// # Errors
/// As [`design`].
pub fn design_for(
    drive: &Drive,
    period_s: f64,
    healthy: &[Vec<Row>],
    (baseline, seed): (usize, u64),
) -> Result<Designed, DesignError> {
    let noise = learn_noise(drive, period_s, healthy)?;
    let drive = with_noise(drive, &noise);
    let process = process(&drive, period_s, &[])?;
    let driving =
        Driving::of(healthy.iter().flatten(), period_s).ok_or(DesignError::NothingDrives)?;
    let how = Calibration {
        driving,
        baseline,
        horizon: samples(HORIZON_S, period_s, FEWEST_HORIZON),
        samples: DESIGNED,
        seed,
    };
    let tails = process.calibrate(&how)?;
    Ok(Designed { noise, drive, process, tails, tails_without_current: None, how })
}
