//! What lies between a caller and the command that it called.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use drivescope_recording::{Recording, Report};
use indicatif::{ProgressBar, ProgressDrawTarget};

/// What a command answered.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answered {
    /// The answer for a person.
    pub text: String,
    /// The answer as `--json` writes it, byte for byte.
    pub json: String,
    /// What was said beside it, a line each.
    pub remarks: Vec<String>,
    /// Recordings that were written into the scratch folder, by their paths.
    pub recordings: HashMap<PathBuf, Recording>,
    /// Whether it is a finding that `--check` forbids.
    pub forbidden: bool,
}

/// How far a command is.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Progress {
    /// What it does.
    pub doing: String,
    /// Steps that are done.
    pub done: u64,
    /// Of how many, where that is known.
    pub of: Option<u64>,
}

/// See the module.
#[derive(Debug)]
pub(crate) struct Desk {
    /// Set when the caller wants the run to end.
    pub(super) stop: Arc<AtomicBool>,
    scratch: PathBuf,
    given: HashMap<PathBuf, (Recording, Report)>,
    answered: Mutex<Answered>,
    bar: Mutex<Option<ProgressBar>>,
}

impl Desk {
    pub(super) fn new(
        recordings: impl IntoIterator<Item = (PathBuf, Recording, Report)>,
        scratch: &Path,
    ) -> Self {
        let given = recordings.into_iter().map(|(name, it, report)| (name, (it, report)));
        Self {
            stop: Arc::default(),
            scratch: scratch.to_owned(),
            given: given.collect(),
            answered: Mutex::default(),
            bar: Mutex::default(),
        }
    }

    /// The recording that was handed over under that name.
    pub(crate) fn recording(&self, name: &Path) -> Option<&(Recording, Report)> {
        self.given.get(name)
    }

    /// Whether a file of that name is none that the user asked for.
    pub(crate) fn is_scratch(&self, path: &Path) -> bool {
        path.starts_with(&self.scratch)
    }

    /// Hands a recording back.
    pub(crate) fn hand_back(&self, path: &Path, recording: Recording) {
        self.answers().recordings.insert(path.to_owned(), recording);
    }

    /// Takes the answer.
    pub(crate) fn answer(&self, text: &str, json: String) {
        let mut answered = self.answers();
        answered.text = text.to_owned();
        answered.json = json;
    }

    /// Takes a remark.
    pub(crate) fn remark(&self, text: String) {
        self.answers().remarks.push(text);
    }

    /// A progress bar that nobody draws, and the caller looks at.
    pub(crate) fn bar(&self, steps: Option<u64>, what: &'static str) -> ProgressBar {
        let nobody = ProgressDrawTarget::hidden();
        let bar = ProgressBar::with_draw_target(steps, nobody).with_message(what);
        *self.bar.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
        bar
    }

    pub(super) fn progress(&self) -> Option<Progress> {
        let bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner).clone()?;
        let (doing, done, of) = (bar.message(), bar.position(), bar.length());
        (!bar.is_finished()).then_some(Progress { doing, done, of })
    }

    pub(super) fn answered(&self, forbidden: bool) -> Answered {
        Answered { forbidden, ..std::mem::take(&mut *self.answers()) }
    }

    fn answers(&self) -> MutexGuard<'_, Answered> {
        self.answered.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
