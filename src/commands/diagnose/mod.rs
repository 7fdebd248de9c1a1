//! `diagnose`: a diagnoser at work on a recording or on live rows from standard input.

mod live;
mod method;
mod pace;
mod regrid;
mod stdin;
mod stream;

use std::path::{Path, PathBuf};

use clap::Args;
use drivescope_diagnoser::{Channel, DetectorKind, Diagnoser};
use drivescope_monitor::{Finished, Found, Method, Monitor, MonitorError, Options};
use drivescope_recording::Recording;

pub(crate) use self::stream::Stream;
use super::{RecordingOptions, Run, at_period};
use crate::answer::diagnose::{BaselineAnswer, DiagnoseAnswer};
use crate::answer::text;
use crate::failure::{Ending, Failure, into_report};
use crate::next::Next;
use crate::output;
use crate::session::Session;

/// Run a diagnoser on a recording, or on rows as they come in: what failed, since when and how large
/// it is where the diagnoser holds a drive (`train --drive`); and what lies outside the thresholds of
/// its detectors, when they declare a fault, and which of the faults it was shown it is.
#[derive(Debug, Args)]
pub(crate) struct Diagnose {
    /// Diagnoser file, as `train` writes it.
    diagnoser: PathBuf,
    /// Recording, or `-` for CSV rows from standard input.
    recording: PathBuf,
    /// A short healthy recording, about 4 to 10 s, of the same machine or day: what differs from
    /// machine to machine is learned from it. A bank without one learns from the first seconds.
    #[arg(long, value_name = "REC")]
    baseline: Option<PathBuf>,
    /// The method whose declarations are the verdict; the others are shown beside it. By default the
    /// best that there is: bank, windows, mem, constant.
    #[arg(long, value_parser = method::parser())]
    method: Option<Method>,
    /// Another share of healthy samples outside the bands than the file's.
    #[arg(long, allow_negative_numbers = true)]
    beta: Option<f64>,
    /// End with exit code 1 if a fault is declared, or the run is abnormal.
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    reading: RecordingOptions,
}

/// Judged windows below which a diagnosis says that it rests on little.
const FEW_WINDOWS: usize = 10;

impl Run for Diagnose {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let diagnoser = Diagnoser::load(&self.diagnoser).map_err(into_report)?;
        session.check_writable(&[])?;
        let baseline = self.baseline(&diagnoser, session)?;
        let asked = self.asked(&diagnoser, baseline.is_some(), session);
        let is_live = self.recording == Path::new("-");
        let (name, monitor, stream) = if is_live {
            let (monitor, stream) = self.live(&diagnoser, baseline.as_ref(), asked, session)?;
            ("standard input".to_owned(), monitor, Some(stream))
        } else {
            let (name, monitor) = self.recorded(&diagnoser, baseline.as_ref(), asked, session)?;
            (name, monitor, None)
        };
        let answer =
            self.answer(&diagnoser, (name, monitor, stream), baseline.as_ref(), session)?;
        let verdict = answer.verdict;
        let next = match (verdict, &answer.fault) {
            // The faults that are known by name are those of the training.
            ("fault", None) if asked != Method::Bank => {
                Next::new("train HEALTHY --fault NAME=REC -o").files([&self.diagnoser])
            }
            _ => Next::new("diagnose").files([&self.diagnoser]).options(" - --check < live.csv"),
        };
        if is_live && session.prints_json() {
            // The last of the lines.
            match output::print(&(output::json_line(&answer)? + "\n")) {
                Err(Failure::Unread) => {}
                printed => printed?,
            }
        } else {
            session.say(&text(&answer.blocks()), &answer, &next)?;
        }
        let forbidden = self.check && ["fault", "abnormal"].contains(&verdict);
        Ok(if forbidden { Ending::Forbidden } else { Ending::Done })
    }
}

impl Diagnose {
    /// A diagnosis of that recording with that diagnoser, as it is where nothing else is said.
    pub(crate) fn on(diagnoser: PathBuf, recording: &Path) -> Self {
        Self {
            diagnoser,
            recording: recording.to_owned(),
            baseline: None,
            method: None,
            beta: None,
            check: false,
            reading: RecordingOptions::default(),
        }
    }

    /// The recording of `--baseline`, at the diagnoser's sampling time.
    fn baseline(
        &self,
        diagnoser: &Diagnoser,
        session: &Session,
    ) -> miette::Result<Option<Recording>> {
        let file = self.baseline.as_ref();
        file.map(|file| read_for(diagnoser, file, &self.reading, session)).transpose()
    }

    /// The method that was asked for, or the best that there is.
    fn asked(&self, diagnoser: &Diagnoser, baseline: bool, session: &Session) -> Method {
        for kind in DetectorKind::ALL {
            if let Some(refusal) = diagnoser.refusal(kind) {
                session.remark(format_args!(
                    "{}: {refusal}: not used{}",
                    kind.label(),
                    if self.method == Some(Method::Residual(kind)) {
                        " unless asked for, as now"
                    } else {
                        ""
                    }
                ));
            }
        }
        self.method.unwrap_or_else(|| Method::best(diagnoser, baseline))
    }

    /// All methods before the first row; `columns` are those of the recording.
    fn monitor(
        &self,
        diagnoser: &Diagnoser,
        baseline: Option<&Recording>,
        (asked, columns): (Method, &[(&str, &str)]),
        session: &Session,
    ) -> miette::Result<Monitor> {
        let options = Options { asked, beta: self.beta };
        let monitor = Monitor::new(diagnoser, columns, options, baseline);
        let monitor = monitor.map_err(|error| refused(&self.diagnoser, &error))?;
        self.remark_on(&monitor, diagnoser, baseline, session);
        Ok(monitor)
    }

    /// Says what the decisions rest on.
    fn remark_on(
        &self,
        monitor: &Monitor,
        diagnoser: &Diagnoser,
        baseline: Option<&Recording>,
        session: &Session,
    ) {
        if let Some(design) = &diagnoser.bank {
            if monitor.is_without_current() && design.limits_without_current.is_some() {
                session.remark(
                    "there is no current I_m, which the diagnoser was trained with: more mechanisms \
                     cannot be told apart, and sets name them",
                );
            }
            if baseline.is_none() {
                session.remark(format_args!(
                    "no --baseline: the machine is learned from the first {:.1} s, which are \
                     taken for healthy",
                    design.baseline as f64 * design.period_s
                ));
            }
        }
    }

    /// What was found, of all methods.
    fn answer(
        &self,
        diagnoser: &Diagnoser,
        (name, monitor, stream): (String, Monitor, Option<Stream>),
        baseline: Option<&Recording>,
        session: &Session,
    ) -> miette::Result<DiagnoseAnswer> {
        let asked = monitor.asked();
        let window = diagnoser.window;
        let Finished { samples, run_up, beyond, machine, methods } = monitor.finish();
        let judged = samples.saturating_sub(run_up);
        if matches!(asked, Method::Residual(_)) && judged < window {
            return Err(Failure::Usage {
                what: format!(
                    "{name}: {samples} samples, of which the first {run_up} only settle the models: \
                     {judged} are left to judge, and a declaration takes {window}"
                ),
                instead: "give a longer recording".to_owned(),
            }
            .into());
        }
        if judged < FEW_WINDOWS * window {
            session.remark(format_args!(
                "{name}: {judged} samples are judged, less than {FEW_WINDOWS} windows of {window}: \
                 the shares outside are rough, and a fault that shows later is not seen"
            ));
        }
        let mut why = None;
        let mut learned = None;
        if let Some(machine) = machine {
            learned = machine.why.is_none().then(|| BaselineAnswer {
                recording: baseline.map_or(&name, |it| &it.name).clone(),
                samples: baseline.map_or(machine.learned, Recording::len),
                machine: machine.changes.into_iter().collect(),
            });
            why = machine.why.filter(|_| asked == Method::Bank);
        }
        let at = methods.iter().position(|found| found.method == asked);
        let Found { verdict, declarations, declared, exceedance_rate, .. } = match at {
            Some(at) => methods[at].clone(),
            None => {
                return Err(
                    refused(&self.diagnoser, &MonitorError::Missing { method: asked }).into()
                );
            }
        };
        let named = declared.iter().filter_map(|declared| declared.fault.as_ref());
        let fault = named.max_by_key(|fault| fault.samples).cloned();
        if verdict == "not_judged" && why.is_none() {
            why = Some(match beyond {
                0 => "the recording is too short".to_owned(),
                _ => "most of it is at operating points that were never shown: not judged here; \
                      train on such runs, give a --baseline there, or train with --drive"
                    .to_owned(),
            });
        }
        Ok(DiagnoseAnswer {
            diagnoser: session.named(&self.diagnoser),
            recording: name,
            samples,
            stream,
            run_up,
            beyond_range: beyond,
            verdict,
            why,
            method: asked,
            declarations,
            share_outside: exceedance_rate,
            fault,
            baseline: learned,
            methods,
        })
    }

    /// Watches a recording at the sampling time of the diagnoser; every row is shown to `each`.
    ///
    /// # Errors
    /// Signals that do not serve, or too few rows.
    pub(crate) fn watched(
        &self,
        diagnoser: &Diagnoser,
        recording: &Recording,
        session: &Session,
        mut each: impl FnMut(&Monitor, usize),
    ) -> miette::Result<DiagnoseAnswer> {
        diagnoser.interface.select(recording).map_err(into_report)?;
        let asked = self.asked(diagnoser, false, session);
        let monitor = self.through(diagnoser, recording, (None, asked), session, &mut each)?;
        self.answer(diagnoser, (recording.name.clone(), monitor, None), None, session)
    }

    fn recorded(
        &self,
        diagnoser: &Diagnoser,
        baseline: Option<&Recording>,
        asked: Method,
        session: &Session,
    ) -> miette::Result<(String, Monitor)> {
        let recording = read_for(diagnoser, &self.recording, &self.reading, session)?;
        diagnoser.interface.select(&recording).map_err(into_report)?;
        let how = (baseline, asked);
        let monitor = self.through(diagnoser, &recording, how, session, &mut |_, _| ())?;
        Ok((recording.name, monitor))
    }

    /// All methods after a whole recording; every row is shown to `each`.
    fn through(
        &self,
        diagnoser: &Diagnoser,
        recording: &Recording,
        (baseline, asked): (Option<&Recording>, Method),
        session: &Session,
        each: &mut dyn FnMut(&Monitor, usize),
    ) -> miette::Result<Monitor> {
        let signals = recording.signals.iter();
        let columns: Vec<(&str, &str)> = signals.map(|s| (&*s.name, &*s.unit)).collect();
        let mut monitor = self.monitor(diagnoser, baseline, (asked, &columns), session)?;
        monitor.run(diagnoser, recording, |monitor, k, _| each(monitor, k)).map_err(into_report)?;
        Ok(monitor)
    }
}

/// Why a machine cannot be watched with the diagnoser of that file, and what to do about it.
pub(crate) fn refused(file: &Path, error: &MonitorError) -> Failure {
    let file = file.display();
    let (what, instead) = match error {
        MonitorError::Missing { method } => (
            format!("{file}: holds no {}", method.label()),
            "train it again with one, or ask for another --method; windows need a --baseline",
        ),
        MonitorError::Windows { .. } => (
            error.to_string(),
            "give a --baseline of this machine that runs healthily, about 4 s of it",
        ),
        MonitorError::Machine { .. } => (
            error.to_string(),
            "give a --baseline of this machine that runs healthily, some seconds of it; for \
             another kind of machine train a diagnoser with its drive",
        ),
        MonitorError::Rows(_) => {
            (error.to_string(), "record it, or name its column with --columns")
        }
        MonitorError::Drive(_) | MonitorError::Process(_) => {
            (format!("{file}: {error}"), "train the diagnoser again")
        }
        MonitorError::Confidence(_) => (error.to_string(), "give --beta between 0 and 1"),
        _ => (error.to_string(), "give a recording of the signals of the training"),
    };
    Failure::Usage { what, instead: instead.to_owned() }
}

/// A recording with the signals that the detectors need, at the diagnoser's sampling time.
pub(crate) fn read_for(
    diagnoser: &Diagnoser,
    file: &Path,
    reading: &RecordingOptions,
    session: &Session,
) -> miette::Result<Recording> {
    let (recording, report) = reading.read(file, session)?;
    report.require(&recording, &names(diagnoser)).map_err(into_report)?;
    at_period(recording, diagnoser.interface.period_s, session)
}

/// The signals that the detectors need.
fn names(diagnoser: &Diagnoser) -> Vec<&str> {
    let interface = &diagnoser.interface;
    let channels = interface.inputs.iter().chain([&interface.output]);
    channels.map(|channel: &Channel| channel.name.as_str()).collect()
}
