//! What a discovery says while it runs: its ladder, rung by rung, on standard error.

use drivescope_discovery::{Step, Watch};
use drivescope_plant::drive::Motion;
use indicatif::ProgressBar;

use crate::answer::discover::{Step as StepOfLadder, table};
use crate::answer::line;
use crate::interrupt::{self, Asked};
use crate::session::Session;

/// Prints rungs as they come, and ends the loop when the user wants that.
pub(crate) struct Watching<'a> {
    session: &'a Session,
    bar: ProgressBar,
    /// Of the drive.
    motion: Motion,
    asked: Asked,
}

impl<'a> Watching<'a> {
    pub(crate) fn new(session: &'a Session, motion: Motion) -> Self {
        Self { session, bar: session.spinner(), motion, asked: interrupt::asked() }
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
            Step::Rung(rung) => self.bar.suspend(|| {
                let only = [StepOfLadder::from(*rung)];
                self.session.remark(line(&table(self.motion, &only)));
            }),
        }
    }

    fn stopped(&self) -> bool {
        self.asked.check().is_err()
    }
}
