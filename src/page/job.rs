//! Long work of a session: it runs beside the server, says how far it is, and can be cancelled.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use drivescope_discovery::{Step, Watch};
use serde::Serialize;

use super::bench::Bench;

/// Errors of fits that are kept to be drawn.
const MOST_ERRORS: usize = 400;

/// What a session is doing.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Job {
    /// Its number in the session.
    #[serde(skip)]
    pub(super) number: u64,
    /// What it is for.
    pub(super) title: String,
    /// What it does now.
    pub(super) doing: String,
    /// Errors that the steps of its fits came to, in units of the noise.
    pub(super) errors: Vec<f64>,
    #[serde(skip)]
    pub(super) cancelled: Arc<AtomicBool>,
}

/// The job as the work sees it.
#[derive(Debug)]
pub(super) struct Progress {
    pub(super) bench: Arc<Bench>,
    pub(super) number: u64,
    pub(super) cancelled: Arc<AtomicBool>,
}

/// The user wants the work to end.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("cancelled")]
pub(super) struct Cancelled;

impl Progress {
    /// Says what is being done; ends the work if the user wants that.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub(super) fn doing(&self, what: &str) -> Result<(), Cancelled> {
        if self.stopped() {
            return Err(Cancelled);
        }
        self.bench.tell(self.number, |job| what.clone_into(&mut job.doing));
        Ok(())
    }

    /// Notes the error that a step of a fit came to; whether the fit is to end.
    pub(super) fn fitting(&self, error: f64) -> bool {
        if error.is_finite() {
            self.bench.tell(self.number, |job| {
                if job.errors.len() < MOST_ERRORS {
                    job.errors.push(error);
                }
            });
        }
        self.stopped()
    }
}

impl Watch for Progress {
    fn step(&self, step: &Step<'_>) {
        match step {
            Step::Doing(what) => {
                self.bench.tell(self.number, |job| (*what).clone_into(&mut job.doing));
            }
            Step::Fitting(error) => {
                self.fitting(*error);
            }
            Step::Rung(_) => {}
        }
    }

    fn compares(&self) -> bool {
        // Every rung is compared on its own.
        false
    }

    fn stopped(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}
