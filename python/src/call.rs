//! A command on a thread of its own, and the calling thread that waits for it.

use std::collections::HashMap;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use drivescope::call::{Answered, Call, Progress, Refused, Watched};
use pyo3::prelude::*;

use crate::raised;
use crate::recording::Recording;

/// How often the waiting thread looks after Ctrl-C and progress.
const LOOK: Duration = Duration::from_millis(50);
/// How long a command that is to end may take to notice. What does not is left to itself: it
/// writes nothing any more, and its answer is dropped.
const GRACE: Duration = Duration::from_millis(500);

/// What a command answered.
#[pyclass(frozen, get_all, module = "drivescope._drivescope")]
pub(crate) struct Answer {
    text: String,
    json: String,
    remarks: Vec<String>,
    forbidden: bool,
    recordings: HashMap<PathBuf, Py<Recording>>,
}

type Outcome = Result<Answered, Refused>;

/// Runs a command. `recordings` are found under their names, what is written into `scratch` is no
/// file of the user's, `progress` is called with what is done, how many steps, of how many.
#[pyfunction]
pub(crate) fn call(
    py: Python<'_>,
    arguments: Vec<OsString>,
    recordings: Vec<(PathBuf, Py<Recording>)>,
    scratch: PathBuf,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Answer> {
    let mut given = Vec::with_capacity(recordings.len());
    for (name, recording) in recordings {
        let (recording, report) = recording.get().handed_over(py, &name)?;
        given.push((name, recording, report));
    }
    let call = Call::new(arguments, given, &scratch);
    let watched = call.watched();
    let (send, outcome) = channel();
    let run = move || {
        // Nobody waits any more for what did not end in time.
        let _ = send.send(call.run());
    };
    std::thread::Builder::new().name("drivescope".to_owned()).spawn(run)?;
    let answered = waited(py, &watched, &Mutex::new(outcome), progress)?.map_err(raised)?;
    let Answered { text, json, remarks, forbidden, recordings } = answered;
    let back = |(path, it)| Ok((path, Py::new(py, Recording::made(py, it)?)?));
    let recordings = recordings.into_iter().map(back).collect::<PyResult<_>>()?;
    Ok(Answer { text, json, remarks, forbidden, recordings })
}

/// Waits for the outcome with Python's lock free; asks the command to end on Ctrl-C, or where the
/// progress function raises.
fn waited(
    py: Python<'_>,
    watched: &Watched,
    outcome: &Mutex<Receiver<Outcome>>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Outcome> {
    let wait = |time| {
        let gone = || Refused::Internal("internal error: the command ended without a word".into());
        py.detach(|| match outcome.lock().map_err(|_| gone())?.recv_timeout(time) {
            Ok(outcome) => Ok(Some(outcome)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(gone()),
        })
        .map_err(raised)
    };
    let mut shown = None;
    loop {
        if let Some(outcome) = wait(LOOK)? {
            return Ok(outcome);
        }
        let looked = py.check_signals().and_then(|()| match &progress {
            Some(progress) => show(progress, watched.progress(), &mut shown),
            None => Ok(()),
        });
        if let Err(ended) = looked {
            watched.stop();
            wait(GRACE)?;
            return Err(ended);
        }
    }
}

fn show(
    progress: &Bound<'_, PyAny>,
    now: Option<Progress>,
    shown: &mut Option<Progress>,
) -> PyResult<()> {
    if let Some(at) = now.as_ref().filter(|_| now != *shown) {
        progress.call1((&at.doing, at.done, at.of))?;
    }
    *shown = now;
    Ok(())
}
