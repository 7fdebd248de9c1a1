//! Runs of a drive's FMU through the co-simulation algorithm.

use drivescope_diagnoser::DetectorError;
use drivescope_fmu::import::{self, Fmu, InstanceOptions};
use drivescope_recording::{Recording, Signal};
use thiserror::Error;

use crate::native::RECORDED;

/// Why a run fails.
#[derive(Debug, Error)]
pub enum RunError {
    /// The FMU.
    #[error(transparent)]
    Fmu(#[from] import::Error),
    /// What follows the run.
    #[error("a diagnoser that follows the run stops")]
    Follower(#[from] DetectorError),
}

/// What follows a run sample by sample.
pub trait Follower {
    /// The control signal and the tachometer signal of the next sample.
    ///
    /// # Errors
    /// A sample that it cannot take.
    fn sample(&mut self, c_m: f64, t: f64) -> Result<(), DetectorError>;
}

impl Follower for () {
    fn sample(&mut self, _: f64, _: f64) -> Result<(), DetectorError> {
        Ok(())
    }
}

/// Runs the closed loop over the inputs; row k as in [`crate::native::closed_loop`].
///
/// # Errors
/// The FMU refuses or the follower stops.
pub fn closed_loop(
    fmu: &Fmu,
    inputs: &Recording,
    follower: &mut impl Follower,
) -> Result<Recording, RunError> {
    let mut drive = fmu.co_simulation(&InstanceOptions::named("drive"))?;
    let set = references(fmu, inputs.signals.iter().map(|signal| signal.name.as_str()))?;
    let get = references(fmu, RECORDED.into_iter())?;
    drive.initialize(inputs.start_s, None, None)?;
    let mut rows = vec![Vec::with_capacity(inputs.len()); RECORDED.len()];
    let mut now = vec![0.0; set.len()];
    let mut shown = [0.0; RECORDED.len()];
    for k in 0..inputs.len() {
        for (value, signal) in now.iter_mut().zip(&inputs.signals) {
            *value = signal.values[k];
        }
        drive.set(&set, &now)?;
        drive.step(inputs.time(k), inputs.period_s)?;
        drive.get(&get, &mut shown)?;
        for (row, value) in rows.iter_mut().zip(shown) {
            row.push(value);
        }
        follower.sample(shown[0], shown[1])?;
    }
    Ok(recorded(fmu, inputs, &RECORDED, rows))
}

/// Runs the open loop over the inputs; row k holds T and I_m at sample k.
///
/// # Errors
/// The FMU refuses.
pub fn open_loop(fmu: &Fmu, inputs: &Recording) -> Result<Recording, RunError> {
    const READ: [&str; 2] = ["T", "I_m"];
    let mut drive = fmu.co_simulation(&InstanceOptions::named("drive"))?;
    let set = references(fmu, inputs.signals.iter().map(|signal| signal.name.as_str()))?;
    let get = references(fmu, READ.into_iter())?;
    drive.initialize(inputs.start_s, None, None)?;
    let mut rows = vec![Vec::with_capacity(inputs.len()); READ.len()];
    let mut now = vec![0.0; set.len()];
    let mut shown = [0.0; READ.len()];
    for k in 0..inputs.len() {
        for (value, signal) in now.iter_mut().zip(&inputs.signals) {
            *value = signal.values[k];
        }
        drive.set(&set, &now)?;
        drive.get(&get, &mut shown)?;
        drive.step(inputs.time(k), inputs.period_s)?;
        for (row, value) in rows.iter_mut().zip(shown) {
            row.push(value);
        }
    }
    Ok(recorded(fmu, inputs, &READ, rows))
}

fn references<'a>(
    fmu: &Fmu,
    names: impl Iterator<Item = &'a str>,
) -> Result<Vec<u32>, import::Error> {
    names.map(|name| Ok(fmu.variable(name)?.reference)).collect()
}

fn recorded(fmu: &Fmu, inputs: &Recording, names: &[&str], rows: Vec<Vec<f64>>) -> Recording {
    let signal = |(name, values): (&&str, Vec<f64>)| Signal {
        name: (*name).to_owned(),
        unit: fmu.variable(name).ok().and_then(|v| v.unit.clone()).unwrap_or_default(),
        values,
    };
    let signals = names.iter().zip(rows).map(signal).collect();
    Recording { signals, ..inputs.clone() }
}
