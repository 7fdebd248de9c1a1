//! The study behind the faults view: run from the page, or a `study.json` that was dropped.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use drivescope_fmu::description::Version;
use drivescope_scenarios::profile::Profile;
use drivescope_scenarios::results::{Pictures, StudyResults, TorqueReading};
use drivescope_scenarios::study::{Progress, StudyError, StudyOptions, study};
use serde::Serialize;
use serde_json::Value;
use tokio::sync::watch;

use super::bench::words;
use crate::failure::{Failure, into_report};
use crate::{drive_source, fmu_file};

/// The drive that is studied, and the bands' confidence level: those of the command.
const DRIVE: &str = "dr300";
const BETA: f64 = 0.05;

/// A running study.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Running {
    /// What it does now.
    pub(super) doing: &'static str,
    /// Runs judged.
    pub(super) done: usize,
    /// Runs to judge; 0 while that is not known.
    pub(super) of: usize,
    #[serde(skip)]
    cancelled: Arc<AtomicBool>,
}

impl Running {
    /// One that begins.
    pub(super) fn begin() -> Self {
        Self { doing: "writing the drive as an FMU", done: 0, of: 0, cancelled: Arc::default() }
    }
}

/// What a study found, and the traces of its runs; a file may hold none.
type Found = (StudyResults, Vec<Pictures>);

/// What the faults view shows.
#[derive(Debug, Default)]
pub(super) struct Shown {
    pub(super) results: Option<Arc<Found>>,
    pub(super) running: Option<Running>,
    /// What went wrong last.
    pub(super) problem: Option<String>,
}

/// The study of a server.
#[derive(Debug)]
pub(super) struct FaultStudy {
    shown: Mutex<Shown>,
    /// Counts the changes.
    pub(super) changes: watch::Sender<u64>,
}

impl Default for FaultStudy {
    fn default() -> Self {
        Self { shown: Mutex::default(), changes: watch::Sender::new(1) }
    }
}

impl FaultStudy {
    /// What is shown, to look at.
    pub(super) fn shown(&self) -> MutexGuard<'_, Shown> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, change: impl FnOnce(&mut Shown)) {
        change(&mut self.shown());
        self.changes.send_modify(|count| *count += 1);
    }

    /// Shows the results of a file.
    ///
    /// # Errors
    /// It is no JSON, no study, one of another version, or more than a page shows.
    pub(super) fn take(&self, text: &str) -> Result<(), String> {
        let mut results: Value =
            serde_json::from_str(text).map_err(|error| format!("it is no JSON: {error}"))?;
        if !results.get("detection").is_some_and(Value::is_array) {
            return Err("it has no `detection`: give the study.json of drivescope study".to_owned());
        }
        let traces = results.as_object_mut().and_then(|results| results.remove("traces"));
        drawable(&results)?;
        let another = |error| {
            format!("another version of drivescope wrote it ({error}): run drivescope study again")
        };
        let results: StudyResults = serde_json::from_value(results).map_err(another)?;
        let traces: Vec<Pictures> =
            traces.map(serde_json::from_value).transpose().map_err(another)?.unwrap_or_default();
        if traces.len() > MOST_RUNS {
            return Err(format!("it has traces of {} runs, more than a page shows", traces.len()));
        }
        self.change(|shown| {
            (shown.results, shown.problem) = (Some(Arc::new((results, traces))), None);
        });
        Ok(())
    }

    /// Ends what is running.
    pub(super) fn cancel(&self) {
        self.change(|shown| {
            if let Some(running) = shown.running.take() {
                running.cancelled.store(true, Ordering::Relaxed);
            }
        });
    }

    /// Begins a study with that seed; its files lie in `folder` while it runs.
    ///
    /// # Errors
    /// One is running.
    pub(super) fn start(self: &Arc<Self>, folder: PathBuf, seed: u64) -> Result<(), String> {
        let running = Running::begin();
        let cancelled = Arc::clone(&running.cancelled);
        let mut begun = false;
        self.change(|shown| {
            if shown.running.is_none() {
                begun = true;
                (shown.running, shown.problem) = (Some(running), None);
            }
        });
        if !begun {
            return Err("a study is running".to_owned());
        }
        let all = Arc::clone(self);
        std::thread::spawn(move || {
            let done = all.run(&folder, seed, &cancelled);
            if cancelled.load(Ordering::Relaxed) {
                return;
            }
            all.change(|shown| {
                shown.running = None;
                match done {
                    Ok(found) => shown.results = Some(Arc::new(found)),
                    Err(error) => shown.problem = Some(words(&error)),
                }
            });
        });
        Ok(())
    }

    fn run(&self, folder: &Path, seed: u64, cancelled: &AtomicBool) -> miette::Result<Found> {
        let drive = drive_source::drive(DRIVE)?;
        let unwritable = |source| Failure::Write { path: folder.to_owned(), source };
        let own = tempfile::Builder::new().tempdir_in(folder).map_err(unwritable)?;
        let (closed, open) = (own.path().join("closed.fmu"), own.path().join("open.fmu"));
        fmu_file::write(&drive, false, Version::Two, &closed)?;
        fmu_file::write(&drive, true, Version::Two, &open)?;
        let options = StudyOptions {
            drive,
            seed,
            torque: TorqueReading::ALL[0],
            beta: BETA,
            profile: Profile::Step,
            further: Vec::new(),
        };
        let progress = |step| {
            self.change(|shown| {
                if let Some(running) = &mut shown.running {
                    tell(running, step);
                }
            });
            cancelled.load(Ordering::Relaxed)
        };
        let outcome = study(&options, (&closed, &open), &progress)
            .map_err(|error: StudyError| into_report(error))?;
        Ok((outcome.results, outcome.pictures))
    }
}

/// Rows of a table, cells of a matrix and runs that the view draws at most.
const MOST_ROWS: usize = 2000;
const MOST_CELLS: usize = 100_000;
const MOST_RUNS: usize = 100;

/// Whether the results can be drawn.
fn drawable(results: &Value) -> Result<(), String> {
    let Some(sections) = results.as_object() else { return Ok(()) };
    for (name, section) in sections {
        let lists = [Some(section), section.get("matrix"), section.get("classes")];
        for rows in lists.into_iter().flatten().filter_map(Value::as_array) {
            let lengths = rows.iter().filter_map(Value::as_array).map(Vec::len);
            let columns = lengths.max().unwrap_or(1);
            if rows.len() > MOST_ROWS || rows.len() * columns > MOST_CELLS {
                return Err(format!(
                    "`{name}` is a table of {} rows and {columns} columns, more than a page shows: \
                     give the study.json of drivescope study",
                    rows.len()
                ));
            }
        }
    }
    Ok(())
}

fn tell(running: &mut Running, step: Progress) {
    match step {
        Progress::Training => running.doing = "training and designing the diagnoser",
        Progress::Judging(runs) => {
            running.of = runs;
            running.doing = "judging faulty and healthy runs";
        }
        Progress::Judged => running.done += 1,
        Progress::Isolation => running.doing = "training classifiers",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_study_is_shown() {
        let study = FaultStudy::default();
        assert!(study.take("{").is_err_and(|it| it.contains("JSON")));
        assert!(study.take("{}").is_err_and(|it| it.contains("detection")));
        let other = study.take(r#"{"detection": []}"#).expect_err("nothing else is in it");
        assert!(other.contains("another version") && other.contains("missing field"), "{other}");
        let rows: Vec<_> = (0..1000).map(|_| vec![0.5; 200]).collect();
        let hostile = serde_json::json!({"detection": [], "isolation": {"matrix": rows}});
        let refused = study.take(&hostile.to_string()).expect_err("more than a page shows");
        assert!(refused.contains("`isolation` is a table of 1000 rows and 200"), "{refused}");
        let mut whole = serde_json::to_value(crate::report::testing::study()).expect("it is data");
        study.take(&whole.to_string()).expect("a study of this program");
        let shown = study.shown().results.clone().expect("it is shown");
        assert!(shown.1.is_empty(), "it holds no traces");
        // As `drivescope study` writes it: with its traces.
        let pictures = crate::report::testing::pictures();
        whole["traces"] = serde_json::to_value(&pictures).expect("they are data");
        study.take(&whole.to_string()).expect("a study of this program");
        let shown = study.shown().results.clone().expect("it is shown");
        assert_eq!(shown.1.len(), pictures.len());
    }
}
