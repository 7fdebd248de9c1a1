//! Training and diagnosing in a session: healthy recordings make a diagnoser, others are watched.
//!
//! ```text
//! recordings, each healthy or to be watched --> train --> diagnoser --> every watched one: Judged
//! ```

mod material;
mod picture;
mod view;
mod work;

use std::sync::Arc;

use serde::Deserialize;

pub(super) use material::Diagnosis;
pub(super) use view::view;

use super::bench::{Bench, State, words};
use super::recordings::Taken;

/// Name of the diagnoser on the command lines that do the same.
pub(super) const FILE: &str = "diagnoser.toml";

/// What the page asks.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(super) enum DiagnosisCommand {
    /// Take a recording of the session.
    Take {
        recording: usize,
        /// Whether it is healthy.
        healthy: bool,
    },
    /// Say what a recording is for.
    Mark {
        name: String,
        /// Whether it is healthy.
        healthy: bool,
    },
    /// Drop a recording.
    Remove { name: String },
    /// Choose the step whose drive the diagnoser is to know.
    Drive {
        /// Which; none for a diagnoser that knows no drive.
        step: Option<usize>,
    },
    /// Train, and judge what is to be watched.
    Train,
    /// Judge what is to be watched.
    Judge,
}

/// Takes a file that was dropped.
///
/// # Errors
/// A recording that cannot be used as it is.
pub(super) fn take(bench: &Arc<Bench>, taken: Taken, healthy: bool) -> Result<(), String> {
    let Some(recording) = taken.recording else {
        let missing = taken.incomplete.map_or(String::new(), |it| it.missing);
        return Err(format!(
            "{}: {missing}. Drop it under \u{201c}Model and measurement\u{201d}, say there what its \
             columns are, and take it from the list here",
            taken.name
        ));
    };
    bench.change(|state| state.diagnosis.take(taken.name, recording, healthy));
    judge(bench);
    Ok(())
}

/// Begins to judge what was not judged yet, if there is a diagnoser and nothing else is done.
pub(super) fn judge(bench: &Arc<Bench>) {
    let waits = {
        let diagnosis = &bench.state().diagnosis;
        let open = diagnosis.material.iter().any(|it| !it.healthy && it.judged.is_none());
        diagnosis.ready.is_some() && open
    };
    if waits {
        // Other work has its turn first; the button begins this one.
        let _ = bench.start("Diagnosing", work::each);
    }
}

impl DiagnosisCommand {
    /// Does it, or begins to.
    ///
    /// # Errors
    /// Why it cannot be done, in words.
    pub(super) fn run(self, bench: &Arc<Bench>) -> Result<(), String> {
        match self {
            Self::Take { recording, healthy } => {
                let of = |state: &State| {
                    let taken = state.recordings.get(recording)?;
                    Some((taken.name.clone(), Arc::clone(taken.recording.as_ref()?)))
                };
                let found = of(&bench.state());
                let (name, recording) = found.ok_or("that recording is not there or incomplete")?;
                bench.change(|state| state.diagnosis.take(name, recording, healthy));
                judge(bench);
            }
            Self::Mark { name, healthy } => {
                bench.change(|state| {
                    if let Some(material) = state.diagnosis.find(&name) {
                        material.healthy = healthy;
                    }
                });
                judge(bench);
            }
            Self::Remove { name } => bench.change(|state| {
                state.diagnosis.changes += 1;
                state.diagnosis.material.retain(|it| it.name != name);
            }),
            Self::Drive { step } => bench.change(|state| {
                state.diagnosis.changes += 1;
                state.diagnosis.step = step.filter(|step| *step < state.steps.len());
            }),
            Self::Judge => judge(bench),
            Self::Train => bench
                .start("Training a diagnoser", work::train_all)
                .map_err(|error| words(&error.into()))?,
        }
        Ok(())
    }
}
