//! A session of work: recordings, a drive, the steps of its ladder, and what is being done.
//!
//! Whoever changes the state holds its lock for a moment; long work runs on copies and hands its
//! result in at the end, if it has not been cancelled until then.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use drivescope_discovery::Evidence;
use drivescope_plant::drive::Drive;
use tokio::sync::watch;

use super::diagnosis::Diagnosis;
use super::job::Job;
use super::recordings::Taken;
use super::session_step::SessionStep;
use super::unit_fix::UnitFix;
use crate::answer::discover::Missing;
use crate::evidence::Gathered;
use crate::failure::Failure;

/// A drive file that the user gave, or one that was made from a recording.
#[derive(Debug, Clone)]
pub(super) struct GivenDrive {
    pub(super) name: String,
    pub(super) text: String,
    /// What it describes.
    pub(super) drive: Drive,
    /// Whether it was made from the first recording.
    pub(super) made: bool,
}

/// What a session knows.
#[derive(Debug, Default)]
pub(super) struct State {
    pub(super) recordings: Vec<Taken>,
    /// The drive to begin with.
    pub(super) drive: Option<GivenDrive>,
    /// The recordings as evidence, parted into those to fit to and those to judge by.
    pub(super) gathered: Option<Arc<Gathered>>,
    /// The recordings as evidence, whole.
    pub(super) whole: Option<Arc<Evidence>>,
    /// Units that look wrong, and what would be right.
    pub(super) fixes: Vec<UnitFix>,
    /// The steps, each after the one that it was made from.
    pub(super) steps: Vec<Arc<SessionStep>>,
    /// What steps lack, as far as that was asked.
    pub(super) missing: BTreeMap<usize, Arc<Missing>>,
    /// Training and diagnosing; it outlasts what begins anew.
    pub(super) diagnosis: Diagnosis,
    /// What is being done.
    pub(super) job: Option<Job>,
    /// What went wrong last.
    pub(super) problem: Option<String>,
    /// Counts how often everything began anew.
    pub(super) beginnings: u64,
    /// Counts the jobs.
    pub(super) jobs: u64,
}

/// A session.
#[derive(Debug)]
pub(super) struct Bench {
    /// Its name in the address: a secret.
    pub(super) id: String,
    /// Seed of everything random.
    pub(super) seed: u64,
    state: Mutex<State>,
    /// Counts the changes of the state.
    pub(super) changes: watch::Sender<u64>,
    /// Held while a window is compared: one at a time.
    pub(super) looking: Mutex<()>,
    /// Counts the windows that were asked for: the latest counts.
    pub(super) looks: AtomicU64,
}

impl Bench {
    pub(super) fn new(id: String, seed: u64) -> Self {
        let changes = watch::Sender::new(1);
        let (state, looking, looks) = Default::default();
        Self { id, seed, state, changes, looking, looks }
    }

    /// The state, to look at.
    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        // Nothing leaves the state half-changed, even if it panics.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state and tells every tab.
    pub(super) fn change<T>(&self, change: impl FnOnce(&mut State) -> T) -> T {
        let done = change(&mut self.state());
        self.changes.send_modify(|count| *count += 1);
        done
    }

    /// Whether something is being done.
    pub(super) fn is_busy(&self) -> bool {
        self.state().job.is_some()
    }

    /// Takes a drive file.
    ///
    /// # Errors
    /// The place in a text that is no drive file.
    pub(super) fn take_drive(&self, name: &str, text: &str) -> miette::Result<()> {
        let parsed = Drive::parse(text, name);
        let drive = parsed.map_err(|error| miette::Report::msg(error.to_string()))?;
        let given = GivenDrive { name: name.to_owned(), text: text.to_owned(), drive, made: false };
        self.change(|state| state.drive = Some(given));
        Ok(())
    }

    /// Takes a recording that the command line named.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub(super) fn take_file(&self, path: &Path) -> miette::Result<()> {
        let taken = Taken::named(path).map_err(miette::Report::msg)?;
        self.change(|state| state.recordings.push(taken));
        Ok(())
    }

    /// Ends what is being done; its result is dropped.
    pub(super) fn cancel(&self) {
        self.change(State::end_job);
    }

    /// Changes what is said of the job of that number, if it is still being done.
    pub(super) fn tell(&self, number: u64, change: impl FnOnce(&mut Job)) {
        self.change(|state| {
            if let Some(job) = state.job.as_mut().filter(|job| job.number == number) {
                change(job);
            }
        });
    }

    /// Hands in a part of the result of the job of that number, if it is still being done.
    pub(super) fn hand_in(&self, number: u64, change: impl FnOnce(&mut State)) {
        self.change(|state| {
            if state.job.as_ref().is_some_and(|job| job.number == number) {
                change(state);
            }
        });
    }
}

impl State {
    /// Ends what is being done.
    pub(super) fn end_job(&mut self) {
        if let Some(job) = self.job.take() {
            job.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Drops what was found.
    pub(super) fn forget(&mut self) {
        self.beginnings += 1;
        self.steps.clear();
        self.missing.clear();
        self.fixes.clear();
        (self.gathered, self.whole, self.problem) = (None, None, None);
    }

    /// The step of that number.
    ///
    /// # Errors
    /// There is none.
    pub(super) fn step(&self, number: usize) -> Result<Arc<SessionStep>, Failure> {
        self.steps.get(number).cloned().ok_or_else(|| Failure::Usage {
            what: format!("there is no step {number}"),
            instead: "reload the page: another tab may have begun anew".to_owned(),
        })
    }
}

/// An error with what helps against it.
pub(super) fn words(error: &miette::Report) -> String {
    error.help().map_or_else(|| error.to_string(), |help| format!("{error}: {help}"))
}
