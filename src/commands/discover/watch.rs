//! What a discovery says while it runs: its ladder, rung by rung, on standard error.

use std::fmt::Write as _;

use drivescope_discovery::{BothUnexplained, Rung, Step, Watch};
use drivescope_plant::drive::Motion;
use indicatif::ProgressBar;

use crate::interrupt::{self, Asked};
use crate::report::words::{balances, in_units_of_noise, output_fits};
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
            Step::Rung(rung) => self.bar.suspend(|| self.session.remark(line(rung, self.motion))),
        }
    }

    fn stopped(&self) -> bool {
        self.asked.check().is_err()
    }
}

/// A rung in words: what the balances of the validation data leave unexplained, and its errors where
/// the noise is in reach.
pub(crate) fn line(rung: &Rung, motion: Motion) -> String {
    let what = rung.added.as_ref().map_or("the base".to_owned(), |it| format!("+ {it}"));
    let known = balances(motion, &rung.validation_unexplained);
    let known = known.into_iter().filter_map(|(balance, left)| Some((balance, left?)));
    let shares: Vec<String> = known
        .map(|(balance, left)| format!("{:.1} % of the {balance}", 100.0 * left.share))
        .collect();
    let mut line = format!("{what:<24}");
    if !shares.is_empty() {
        let _ = write!(line, " unexplained {}", shares.join(", "));
    }
    let fits = output_fits(&rung.validation_fit_percent);
    if !fits.is_empty() {
        let _ = write!(line, "   fit {}", fits.join(", "));
    }
    if has_errors(rung) {
        let [error, validation] = [rung.error, rung.validation_error];
        let _ = write!(line, "   error {error:>9.4}   validation {validation:>9.4}");
    }
    line
}

/// Whether a rung's errors are told: where the noise is in reach, or nothing else is known.
pub(crate) fn has_errors(rung: &Rung) -> bool {
    let BothUnexplained { torque, voltage } = rung.validation_unexplained;
    let in_reach = in_units_of_noise(rung.error.max(rung.validation_error));
    in_reach || (torque.is_none() && voltage.is_none())
}
