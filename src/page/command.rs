//! What the page asks a session to do.

use std::sync::Arc;

use drivescope_plant::drive::Drive;
use drivescope_plant::file::Change;
use serde::Deserialize;

use super::bench::{Bench, words};
use super::example::Example;
use super::law::TypedLaw;
use super::recordings::Taken;
use super::session_step::SessionStep;
use super::work;
use crate::failure::{Failure, into_report};

/// A command, as the page sends it.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(super) enum Command {
    /// Take an example in place of what there is.
    Example {
        /// Its name.
        id: String,
    },
    /// Take a column as a signal in a unit.
    Column { recording: usize, column: String, signal: String, unit: String },
    /// Sample a recording every so many milliseconds, or as it was sampled.
    Resample {
        recording: usize,
        /// Sampling time, ms.
        ms: Option<f64>,
    },
    /// Take the rows of a recording as sampled every so many milliseconds.
    RowsEvery {
        recording: usize,
        /// Sampling time, ms.
        ms: Option<f64>,
    },
    /// Forget what was said of a recording.
    Again { recording: usize },
    /// Drop a recording.
    Remove { recording: usize },
    /// Ask what the drive of a step lacks.
    Learn { step: usize },
    /// Add an effect of the library, or `learned`.
    Add { step: usize, effect: String },
    /// Add a typed law.
    Law { step: usize, law: TypedLaw },
    /// Set a parameter, nothing fitted.
    Set {
        step: usize,
        /// The parameter.
        name: String,
        /// Its value, SI.
        value: f64,
    },
    /// Fit the drive of a step again.
    Fit { step: usize },
    /// End what is being done.
    Cancel,
}

impl Command {
    /// Does it, or begins to.
    ///
    /// # Errors
    /// Why it cannot be done, in words.
    pub(super) fn run(self, bench: &Arc<Bench>) -> Result<(), String> {
        let said = |error: Failure| words(&error.into());
        match self {
            Self::Cancel => {
                bench.cancel();
                Ok(())
            }
            Self::Example { id } => {
                let example = Example::find(&id).map_err(said)?;
                let (recordings, drive) = example.recorded().map_err(|error| words(&error))?;
                bench.change(|state| {
                    state.recordings = recordings;
                    state.drive = Some(drive);
                });
                bench.analyse();
                Ok(())
            }
            Self::Column { recording, column, signal, unit } => {
                again(bench, recording, |taken| taken.map(&column, &signal, &unit))
            }
            Self::Resample { recording, ms } => {
                again(bench, recording, |taken| taken.resample(ms.map(|ms| ms / 1e3)))
            }
            Self::RowsEvery { recording, ms } => {
                again(bench, recording, |taken| taken.rows_every(ms.map(|ms| ms / 1e3)))
            }
            Self::Again { recording } => again(bench, recording, Taken::again),
            Self::Remove { recording } => {
                bench.change(|state| {
                    if recording < state.recordings.len() {
                        state.recordings.remove(recording);
                    }
                });
                bench.analyse();
                Ok(())
            }
            Self::Learn { step } => {
                bench.state().step(step).map_err(said)?;
                bench.start("Learning", move |progress| work::learn(progress, step)).map_err(said)
            }
            Self::Add { step, effect } => {
                bench.state().step(step).map_err(said)?;
                let title = format!("Adding {}", effect.replace('_', " "));
                bench
                    .start(&title, move |progress| work::extend(progress, step, &effect))
                    .map_err(said)
            }
            Self::Law { step, law } => {
                let on = bench.state().step(step).map_err(said)?;
                let law = law.understood(&on.compared.curves).map_err(|wrong| wrong.words)?;
                let fresh = law.added(&on).map_err(said)?;
                bench
                    .start("Adding a law", move |progress| work::refit(progress, step, fresh))
                    .map_err(said)
            }
            Self::Set { step, name, value } => {
                let on = bench.state().step(step).map_err(said)?;
                let fresh = with_value(&on, &name, value)?;
                bench
                    .start("Setting a value", move |progress| work::judge(progress, step, fresh))
                    .map_err(said)
            }
            Self::Fit { step } => {
                let on = bench.state().step(step).map_err(said)?;
                let fresh = ("fitted again".to_owned(), on.text.clone());
                bench
                    .start("Fitting", move |progress| work::refit(progress, step, fresh))
                    .map_err(said)
            }
        }
    }
}

/// Changes how a recording is read, and begins anew.
fn again(
    bench: &Arc<Bench>,
    recording: usize,
    change: impl FnOnce(&mut Taken) -> Result<(), String>,
) -> Result<(), String> {
    bench.change(|state| {
        let taken = state.recordings.get_mut(recording);
        change(taken.ok_or_else(|| format!("there is no recording {recording}"))?)
    })?;
    bench.analyse();
    Ok(())
}

/// What is done, and the drive file of the step with that value in it.
fn with_value(step: &SessionStep, name: &str, value: f64) -> Result<(String, String), String> {
    let mut drive = step.drive.clone();
    drive.set(name, value).map_err(|error| error.to_string())?;
    let change = Change { name: name.to_owned(), value, origin: "set by hand".to_owned() };
    let mut changes = vec![change.clone()];
    if drive.motor.tie_k && name == "K_e" {
        changes.push(Change { name: "K_m".to_owned(), ..change });
    }
    let (text, _) = Drive::edited(&step.text, "the drive", &changes)
        .map_err(|error| into_report(error).to_string())?;
    Ok((format!("{name} = {value} by hand"), text))
}
