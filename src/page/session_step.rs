//! A step of the ladder: a drive, how well it explains the recordings, and what it lacks.

use drivescope_discovery::compare::Comparison;
use drivescope_discovery::{BothUnexplained, Estimate, NotIdentifiable, OutputFits, Setting};
use drivescope_plant::drive::Drive;

use crate::answer::compare::Setting as About;
use crate::answer::discover::Step;

/// A step of the user's way.
#[derive(Debug)]
pub(super) struct SessionStep {
    /// The step that it was made from.
    pub(super) parent: Option<usize>,
    /// What was done.
    pub(super) label: String,
    /// The command line that does the same.
    pub(super) command: String,
    pub(super) drive: Drive,
    /// Its drive file.
    pub(super) text: String,
    /// What is frozen for runs of it.
    pub(super) setting: Setting,
    /// Its parameters; those that were not estimated have no standard error.
    pub(super) parameters: Vec<Estimate>,
    /// What the recordings do not tell.
    pub(super) not_identifiable: Vec<NotIdentifiable>,
    /// What the balances leave unexplained of those that only judge.
    pub(super) unexplained: BothUnexplained,
    /// Fit of each output of those that only judge, %.
    pub(super) fits: OutputFits,
    /// Error on the recordings, or parts of them, that it was fitted to.
    pub(super) error: f64,
    /// Error on those that only judge.
    pub(super) validation_error: f64,
    /// It against the whole recordings.
    pub(super) compared: Comparison,
    /// What the comparison rests on.
    pub(super) about: About,
}

impl SessionStep {
    /// As a step of a ladder that stands so deep.
    pub(super) fn shown(&self, depth: usize) -> Step {
        Step {
            label: self.label.clone(),
            unexplained: self.unexplained,
            fits: self.fits.clone(),
            error: self.error,
            validation_error: self.validation_error,
            depth,
        }
    }

    /// Steps above that one.
    pub(super) fn depth(all: &[std::sync::Arc<Self>], mut of: usize) -> usize {
        let mut depth = 0;
        while let Some(parent) = all[of].parent {
            depth += 1;
            of = parent;
        }
        depth
    }
}
