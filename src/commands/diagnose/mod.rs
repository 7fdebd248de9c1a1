//! `diagnose`: a diagnoser at work on a recording or on live rows from standard input.

mod answer;
mod bank;
mod declaration;
mod live;
mod method;
mod outside;
mod watch;

use std::path::{Path, PathBuf};

use clap::Args;
use drivescope_diagnoser::{Channel, Diagnoser, ThresholdKind};
use drivescope_recording::Recording;
use drivescope_scenarios::bank::Columns;

use self::answer::{Answer, BaselineAnswer, Declared, Found};
use self::bank::{Bank, BankFound, Decision, SHARE_OUTSIDE};
use self::method::Method;
use self::watch::{Event, Finished, Watch};
use super::{RecordingOptions, Run, at_period};
use crate::failure::{Ending, Failure, told};
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
    #[arg(long, value_enum)]
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

/// All methods at work.
struct Working {
    watch: Watch,
    bank: Option<Bank>,
}

/// What a row brought.
enum Happened {
    Event(Event),
    Decision(Decision),
}

impl Working {
    fn begin(&mut self) {
        self.watch.begin();
        self.bank.iter_mut().for_each(Bank::begin);
    }

    /// Takes a row: inputs and output of the detectors, and the value of each column.
    fn step(
        &mut self,
        (u, y): (&[f64], f64),
        value: impl Fn(usize) -> f64,
        time: f64,
    ) -> miette::Result<Vec<Happened>> {
        let events = self.watch.step(u, y, time)?;
        let decision = self.bank.as_mut().and_then(|bank| {
            let row = bank.columns().row(value);
            bank.step(&row, time)
        });
        Ok(events
            .into_iter()
            .map(Happened::Event)
            .chain(decision.map(Happened::Decision))
            .collect())
    }
}

impl Run for Diagnose {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let diagnoser = Diagnoser::load(&self.diagnoser).map_err(told)?;
        session.check_writable(&[])?;
        let baseline = self.baseline(&diagnoser, session)?;
        let asked = self.asked(&diagnoser, baseline.is_some(), session);
        let is_live = self.recording == Path::new("-");
        let (name, working) = if is_live {
            let working = self.live(&diagnoser, baseline.as_ref(), asked, session)?;
            ("standard input".to_owned(), working)
        } else {
            self.recorded(&diagnoser, baseline.as_ref(), asked, session)?
        };
        let Working { watch, bank } = working;
        let window = diagnoser.window;
        let Finished { samples, run_up, beyond, mut methods } = watch.finish();
        let judged = samples.saturating_sub(run_up);
        if asked.of_paper().is_some() && judged < window {
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
        if let Some(found) = bank.map(Bank::found) {
            learned = found.why.is_none().then(|| BaselineAnswer {
                recording: baseline.as_ref().map_or(&name, |it| &it.name).clone(),
                samples: baseline.as_ref().map_or(found.learned, Recording::len),
                machine: found.machine.iter().cloned().collect(),
            });
            why = found.why.clone().filter(|_| asked == Method::Bank);
            methods.insert(0, of_bank(found));
        }
        let at = methods.iter().position(|found| found.method == asked);
        let Found { verdict, declarations, declared, exceedance_rate, .. } = match at {
            Some(at) => methods[at].clone(),
            None => {
                return Err(Failure::Usage {
                    what: format!("{}: holds no {}", self.diagnoser.display(), asked.label()),
                    instead:
                        "train it again with one, or ask for another --method; windows need a \
                              --baseline"
                            .to_owned(),
                }
                .into());
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
        let answer = Answer {
            diagnoser: self.diagnoser,
            recording: name,
            samples,
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
        };
        let next = match (verdict, &answer.fault) {
            // The faults that are known by name are those of the training.
            ("fault", None) if asked != Method::Bank => {
                Next::new("train HEALTHY --fault NAME=REC -o").files([&answer.diagnoser])
            }
            _ => Next::new("diagnose").files([&answer.diagnoser]).options(" - --check < live.csv"),
        };
        if is_live && session.prints_json() {
            // The last of the lines.
            match output::print(&(output::json_line(&answer)? + "\n")) {
                Err(Failure::Unread) => {}
                printed => printed?,
            }
        } else {
            session.say(&answer.text(), &answer, &next)?;
        }
        let forbidden = self.check && ["fault", "abnormal"].contains(&verdict);
        Ok(if forbidden { Ending::Forbidden } else { Ending::Done })
    }
}

/// The bank's row of the table.
fn of_bank(found: BankFound) -> Found {
    let share = found.counted.share();
    let declared = found.declarations.iter().map(|it| Declared {
        sample: it.sample,
        time: it.noticed,
        fault: None,
    });
    Found {
        method: Method::Bank,
        verdict: if found.why.is_some() {
            "not_judged"
        } else if !found.declarations.is_empty() {
            "fault"
        } else if found.counted.is_abnormal(SHARE_OUTSIDE) {
            "abnormal"
        } else {
            "healthy"
        },
        beta: Some(SHARE_OUTSIDE),
        judged: found.counted.judged,
        outside: found.counted.outside,
        exceedance_rate: share,
        declared: declared.collect(),
        declarations: found.declarations,
    }
}

impl Diagnose {
    /// The recording of `--baseline`, at the diagnoser's sampling time.
    fn baseline(
        &self,
        diagnoser: &Diagnoser,
        session: &Session,
    ) -> miette::Result<Option<Recording>> {
        let Some(file) = &self.baseline else { return Ok(None) };
        let (recording, report) = self.reading.read(file, session)?;
        report.require(&recording, &names(diagnoser)).map_err(told)?;
        Ok(Some(at_period(recording, diagnoser.interface.period_s, session)?))
    }

    /// The method that was asked for, or the best that there is.
    fn asked(&self, diagnoser: &Diagnoser, baseline: bool, session: &Session) -> Method {
        for (method, kind) in [
            (Method::Mem, ThresholdKind::ModelError),
            (Method::MemRecurrent, ThresholdKind::RecurrentModelError),
        ] {
            let there = method == Method::Mem || diagnoser.recurrent_error.is_some();
            if there && !diagnoser.explains(kind) {
                session.remark(format_args!(
                    "{}: its bands are wider than those of the plain residual: not used{}",
                    method.label(),
                    if self.method == Some(method) { " unless asked for, as now" } else { "" }
                ));
            }
        }
        self.method.unwrap_or(if diagnoser.bank.is_some() {
            Method::Bank
        } else if baseline && diagnoser.windows.is_some() {
            Method::Windows
        } else if diagnoser.explains(ThresholdKind::ModelError) {
            Method::Mem
        } else {
            Method::Constant
        })
    }

    /// All methods before the first row; `columns` are those of the recording.
    fn working(
        &self,
        diagnoser: &Diagnoser,
        baseline: Option<&Recording>,
        (asked, columns): (Method, &[(&str, &str)]),
        session: &Session,
    ) -> miette::Result<Working> {
        let data = baseline.map(|baseline| {
            let data = diagnoser.interface.select(baseline).map_err(told)?;
            Ok::<_, miette::Report>((baseline.name.as_str(), data))
        });
        let data = data.transpose()?;
        let of_baseline = data.as_ref().map(|(name, data)| (*name, data));
        let watch = Watch::new(diagnoser, asked, self.beta, of_baseline)?;
        let bank = diagnoser.bank.as_ref().map(|design| {
            let words = |error: drivescope_scenarios::bank::RowsError| Failure::Usage {
                what: error.to_string(),
                instead: "record it, or name its column with --columns".to_owned(),
            };
            let columns = Columns::find(columns).map_err(words)?;
            if !columns.has_current() && design.limits_without_current.is_some() {
                session.remark(
                    "there is no current I_m, which the diagnoser was trained with: more mechanisms \
                     cannot be told apart, and sets name them",
                );
            }
            match baseline {
                None => {
                    session.remark(format_args!(
                        "no --baseline: the machine is learned from the first {:.1} s, which are \
                         taken for healthy",
                        design.baseline as f64 * design.period_s
                    ));
                    Bank::new(design, columns, None)
                }
                Some(baseline) => {
                    // A machine is learned from a run without gaps.
                    let parts = baseline.parts();
                    let longest = parts.iter().max_by_key(|part| part.len()).unwrap_or(baseline);
                    let (_, rows) = Columns::of(longest).map_err(words)?;
                    Bank::new(design, columns, Some((&baseline.name, &rows)))
                }
            }
        });
        Ok(Working { watch, bank: bank.transpose()? })
    }

    fn recorded(
        &self,
        diagnoser: &Diagnoser,
        baseline: Option<&Recording>,
        asked: Method,
        session: &Session,
    ) -> miette::Result<(String, Working)> {
        let (recording, report) = self.reading.read(&self.recording, session)?;
        let interface = &diagnoser.interface;
        report.require(&recording, &names(diagnoser)).map_err(told)?;
        let recording = at_period(recording, interface.period_s, session)?;
        let data = interface.select(&recording).map_err(told)?;
        let signals = recording.signals.iter();
        let columns: Vec<(&str, &str)> = signals.map(|s| (&*s.name, &*s.unit)).collect();
        let mut working = self.working(diagnoser, baseline, (asked, &columns), session)?;
        let mut u = vec![0.0; data.inputs().len()];
        for (k, y) in data.output().values.iter().enumerate() {
            if recording.breaks.iter().any(|it| it.at == k) {
                working.begin();
            }
            u.iter_mut().zip(data.inputs()).for_each(|(u, column)| *u = column.values[k]);
            let value = |at: usize| recording.signals[at].values[k];
            working.step((&u, *y), value, recording.time(k))?;
        }
        Ok((recording.name.clone(), working))
    }
}

/// The signals that the detectors need.
fn names(diagnoser: &Diagnoser) -> Vec<&str> {
    let interface = &diagnoser.interface;
    let channels = interface.inputs.iter().chain([&interface.output]);
    channels.map(|channel: &Channel| channel.name.as_str()).collect()
}
