//! What a discovery says while it runs: its ladder, step by step, on standard error.

use std::sync::{Mutex, PoisonError};

use drivescope_discovery::{Step, Watch};
use drivescope_plant::drive::Motion;
use indicatif::ProgressBar;

use crate::answer::discover::{Step as StepOfLadder, table};
use crate::answer::line;
use crate::interrupt::{self, Asked};
use crate::session::Session;

/// Prints the steps of the ladder as they come, and ends the loop when the user wants that.
pub(crate) struct Watching<'a> {
    session: &'a Session,
    bar: ProgressBar,
    /// Of the drive.
    motion: Motion,
    /// The ladder so far.
    steps: Mutex<Vec<StepOfLadder>>,
    asked: Asked,
}

impl<'a> Watching<'a> {
    pub(crate) fn new(session: &'a Session, motion: Motion) -> Self {
        let (bar, steps) = (session.spinner(), Mutex::default());
        Self { session, bar, motion, steps, asked: interrupt::asked() }
    }

    /// Takes the progress away.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}

impl Watch for Watching<'_> {
    fn step(&self, step: &Step<'_>) {
        match step {
            Step::Doing(what) => self.bar.set_message(*what),
            Step::Fitting(_) => {}
            Step::Ladder(step) => self.bar.suspend(|| {
                let mut steps = self.steps.lock().unwrap_or_else(PoisonError::into_inner);
                steps.push(StepOfLadder::from(*step));
                self.session.remark(line(&table(self.motion, &steps)));
            }),
        }
    }

    fn stopped(&self) -> bool {
        self.asked.check().is_err()
    }
}
