//! Long work of a session: it runs beside the server, says how far it is, and can be cancelled.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use drivescope_discovery::{Step, Watch};

use super::bench::{Bench, State, words};
use super::job::{Cancelled, Job};
use super::plain::plain;
use crate::failure::Failure;

/// Errors of fits that are kept to be drawn.
const MOST_ERRORS: usize = 400;

/// A job as the work sees it.
#[derive(Debug)]
pub(super) struct Progress {
    pub(super) bench: Arc<Bench>,
    pub(super) number: u64,
    pub(super) cancelled: Arc<AtomicBool>,
}

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
            Step::Ladder(_) => {}
        }
    }

    fn compares(&self) -> bool {
        // Every step is compared on its own.
        false
    }

    fn stopped(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl Bench {
    /// Begins long work; `work` gets its progress and answers with what changes in the state.
    ///
    /// # Errors
    /// Other work is under way.
    pub(super) fn start<W, C>(self: &Arc<Self>, title: &str, work: W) -> Result<(), Failure>
    where
        W: FnOnce(&Progress) -> miette::Result<C> + Send + 'static,
        C: FnOnce(&mut State),
    {
        let begun = self.begin(title, |state| state.job.is_none(), work);
        if begun { Ok(()) } else { Err(busy()) }
    }

    /// Begins long work where the state, made ready under one lock, allows it.
    pub(super) fn begin<W, C>(
        self: &Arc<Self>,
        title: &str,
        ready: impl FnOnce(&mut State) -> bool,
        work: W,
    ) -> bool
    where
        W: FnOnce(&Progress) -> miette::Result<C> + Send + 'static,
        C: FnOnce(&mut State),
    {
        let cancelled = Arc::new(AtomicBool::new(false));
        let number = self.change(|state| {
            if !ready(state) {
                return None;
            }
            state.jobs += 1;
            state.problem = None;
            state.job = Some(Job {
                number: state.jobs,
                title: title.to_owned(),
                doing: "beginning".to_owned(),
                errors: Vec::new(),
                cancelled: Arc::clone(&cancelled),
            });
            Some(state.jobs)
        });
        let Some(number) = number else { return false };
        let progress = Progress { bench: Arc::clone(self), number, cancelled };
        std::thread::spawn(move || {
            let done = catch_unwind(AssertUnwindSafe(|| work(&progress)));
            progress.bench.change(|state| {
                // What was cancelled has no say any more.
                if state.job.take_if(|job| job.number == number).is_none() {
                    return;
                }
                match done {
                    Ok(Ok(change)) => change(state),
                    Ok(Err(error)) if error.downcast_ref::<Cancelled>().is_some() => {}
                    Ok(Err(error)) => state.problem = Some(plain(&words(&error))),
                    Err(_) => state.problem = Some("an internal error ended the work".to_owned()),
                }
            });
        });
        true
    }
}

fn busy() -> Failure {
    Failure::Usage {
        what: "other work is under way in this session".to_owned(),
        instead: "wait for it, or cancel it".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    type Change = fn(&mut State);

    #[test]
    fn what_was_cancelled_changes_nothing() {
        let bench = Arc::new(Bench::new("a".to_owned(), 1));
        let (go, wait) = mpsc::channel::<()>();
        let work = move |_: &Progress| -> miette::Result<Change> {
            let _ = wait.recv();
            Ok(|state| state.problem = Some("too late".to_owned()))
        };
        bench.start("waiting", work).expect("nothing is being done");
        let second = bench.start("another", |_: &Progress| Ok((|_| {}) as Change));
        assert!(second.is_err(), "one at a time");
        bench.cancel();
        assert!(!bench.is_busy());
        let mut changes = bench.changes.subscribe();
        let before = *changes.borrow_and_update();
        go.send(()).expect("it waits");
        while *changes.borrow() == before {
            std::thread::yield_now();
        }
        assert_eq!(bench.state().problem, None);
    }

    #[test]
    fn a_panic_is_told_and_leaves_a_usable_session() {
        let bench = Arc::new(Bench::new("a".to_owned(), 1));
        let work = |_: &Progress| -> miette::Result<Change> { panic!("for the test") };
        bench.start("failing", work).expect("nothing is being done");
        while bench.is_busy() {
            std::thread::yield_now();
        }
        assert!(bench.state().problem.as_ref().is_some_and(|it| it.contains("internal")));
        assert!(bench.start("again", |_: &Progress| Ok((|_| {}) as Change)).is_ok());
    }
}
