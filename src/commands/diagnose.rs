//! `diagnose`: a diagnoser at work on a recording or on live rows from standard input.

use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use drivescope_diagnoser::{Confidence, Detector, Diagnoser, ModelRun, ThresholdRun};
use drivescope_recording::{CsvStream, Mapping, ReadOptions};
use drivescope_scenarios::results::Method;
use serde::Serialize;

use super::{RecordingOptions, Run};
use crate::failure::{Ending, Failure, told};
use crate::session::Session;
use crate::{interrupt, output};

/// Run a diagnoser on a recording, or on rows as they come in: what lies outside its thresholds, and
/// when a fault is declared.
#[derive(Debug, Args)]
pub(crate) struct Diagnose {
    /// Diagnoser file, as `train` writes it.
    diagnoser: PathBuf,
    /// Recording, or `-` for CSV rows from standard input.
    recording: PathBuf,
    /// The method whose declarations are the verdict; the others are shown beside it.
    #[arg(long, value_enum, default_value_t = Asked::Mem)]
    method: Asked,
    /// Another share of healthy samples outside the bands than the file's.
    #[arg(long, allow_negative_numbers = true)]
    beta: Option<f64>,
    /// End with exit code 1 if a fault is declared.
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    reading: RecordingOptions,
}

/// Methods that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Asked {
    /// Bands by model error modelling, ARX error model.
    Mem,
    /// The same with the recurrent error model.
    MemRecurrent,
    /// Constant thresholds.
    Constant,
    /// Intervals of the GMDH network.
    Gmdh,
}

impl From<Asked> for Method {
    fn from(asked: Asked) -> Self {
        match asked {
            Asked::Mem => Self::Mem,
            Asked::MemRecurrent => Self::MemRecurrent,
            Asked::Constant => Self::Constant,
            Asked::Gmdh => Self::Gmdh,
        }
    }
}

#[derive(Debug, Serialize)]
struct Answer {
    diagnoser: PathBuf,
    recording: String,
    samples: usize,
    run_up: usize,
    verdict: &'static str,
    method: Method,
    methods: Vec<Found>,
}

#[derive(Debug, Clone, Serialize)]
struct Found {
    method: Method,
    /// None for a method that knows no such level.
    beta: Option<f64>,
    outside: usize,
    /// None if nothing was judged.
    exceedance_rate: Option<f64>,
    declared: Vec<Declared>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Declared {
    /// Samples from the start of the recording, the one that completes the window included.
    sample: usize,
    /// Its time, s.
    time: f64,
}

/// A detector with what it found so far, in memory that grows only with declarations.
struct Watching {
    detector: Detector<ModelRun, ThresholdRun>,
    found: Found,
    standing: bool,
}

/// All methods of a diagnoser over rows of one signal set.
struct Watch {
    watching: Vec<Watching>,
    run_up: usize,
    samples: usize,
}

impl Watch {
    fn new(diagnoser: &Diagnoser, beta: Option<f64>) -> miette::Result<Self> {
        let confidence = match beta {
            Some(beta) => Confidence::new(beta).map_err(told)?,
            None => diagnoser.confidence,
        };
        let has = |method: &Method| match method {
            Method::Mem | Method::Constant => true,
            Method::MemRecurrent => diagnoser.recurrent_error.is_some(),
            Method::Gmdh => diagnoser.gmdh.is_some(),
        };
        let watching = Method::ALL.into_iter().filter(has).map(|method| {
            let detector = diagnoser.detector_at(method.kind(), confidence).map_err(told)?;
            let beta = (method != Method::Gmdh).then_some(confidence.beta());
            let (declared, exceedance_rate) = (Vec::new(), None);
            let found = Found { method, beta, outside: 0, exceedance_rate, declared };
            Ok(Watching { detector, found, standing: false })
        });
        let watching = watching.collect::<miette::Result<_>>()?;
        Ok(Self { watching, run_up: diagnoser.run_up, samples: 0 })
    }

    /// Takes a sample; the methods that declare a fault with it.
    fn step(&mut self, u: &[f64], y: f64, time: f64) -> miette::Result<Vec<Method>> {
        let mut now = Vec::new();
        for Watching { detector, found, standing } in &mut self.watching {
            let verdict = detector.step(u, y).map_err(told)?;
            found.outside += usize::from(verdict.exceeds);
            if verdict.declared && !*standing {
                found.declared.push(Declared { sample: self.samples + 1, time });
                now.push(found.method);
            }
            *standing = verdict.declared;
        }
        self.samples += 1;
        Ok(now)
    }

    fn finish(self) -> (usize, Vec<Found>) {
        let judged = self.samples.saturating_sub(self.run_up);
        let found = self.watching.into_iter().map(|Watching { mut found, .. }| {
            found.exceedance_rate = (judged > 0).then(|| found.outside as f64 / judged as f64);
            found
        });
        (self.samples, found.collect())
    }
}

impl Run for Diagnose {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let diagnoser = Diagnoser::load(&self.diagnoser).map_err(told)?;
        session.check_writable(&[])?;
        let watch = Watch::new(&diagnoser, self.beta)?;
        let asked = Method::from(self.method);
        if !watch.watching.iter().any(|watching| watching.found.method == asked) {
            return Err(Failure::Usage {
                what: format!("{}: holds no {}", self.diagnoser.display(), asked.label()),
                instead: "train it again with one, or ask for another --method".to_owned(),
            }
            .into());
        }
        let (name, watch) = if self.recording == Path::new("-") {
            ("standard input".to_owned(), self.live(&diagnoser, watch, session)?)
        } else {
            self.recorded(&diagnoser, watch, session)?
        };
        let run_up = watch.run_up;
        let (samples, methods) = watch.finish();
        if samples <= run_up {
            return Err(Failure::Usage {
                what: format!(
                    "{name}: {samples} samples, and the first {run_up} only settle the models: \
                     nothing was judged"
                ),
                instead: "give a longer recording".to_owned(),
            }
            .into());
        }
        let declared =
            methods.iter().any(|found| found.method == asked && !found.declared.is_empty());
        let verdict = if declared { "fault" } else { "healthy" };
        let (diagnoser, method) = (self.diagnoser, asked);
        let answer =
            Answer { diagnoser, recording: name, samples, run_up, verdict, method, methods };
        session.answer(&text(&answer), &answer)?;
        Ok(if declared && self.check { Ending::Forbidden } else { Ending::Done })
    }
}

impl Diagnose {
    fn recorded(
        &self,
        diagnoser: &Diagnoser,
        mut watch: Watch,
        session: &Session,
    ) -> miette::Result<(String, Watch)> {
        let (recording, report) = self.reading.read(&self.recording, session)?;
        let interface = &diagnoser.interface;
        let channels = interface.inputs.iter().chain([&interface.output]);
        let names: Vec<&str> = channels.map(|channel| channel.name.as_str()).collect();
        report.require(&recording, &names).map_err(told)?;
        let data = interface.select(&recording).map_err(told)?;
        let mut u = vec![0.0; data.inputs().len()];
        for (k, y) in data.output().values.iter().enumerate() {
            u.iter_mut().zip(data.inputs()).for_each(|(u, column)| *u = column.values[k]);
            watch.step(&u, *y, recording.time(k))?;
        }
        Ok((recording.name.clone(), watch))
    }

    /// Rows as they come in: a declaration is said at once.
    fn live(
        &self,
        diagnoser: &Diagnoser,
        mut watch: Watch,
        session: &Session,
    ) -> miette::Result<Watch> {
        /// Departure of the mean sampling time from the diagnoser's that is taken for jitter.
        const SAME_PERIOD: f64 = 0.01;
        let columns = self.reading.columns().map(Mapping::parse_list).transpose();
        let options =
            ReadOptions { columns: columns.map_err(told)?.unwrap_or_default(), resample: None };
        let stdin = io::stdin().lock();
        let mut rows = CsvStream::new(stdin, "standard input", &options).map_err(told)?;
        let interface = &diagnoser.interface;
        let place = |channel: &drivescope_diagnoser::Channel| -> miette::Result<usize> {
            let columns = rows.columns();
            let found = columns.iter().position(|column| column.signal == channel.name);
            let at = found.ok_or_else(|| Failure::Usage {
                what: format!("standard input: there is no signal `{}`", channel.name),
                instead: "name its column with --columns".to_owned(),
            })?;
            if columns[at].unit != channel.unit {
                return Err(Failure::Usage {
                    what: format!(
                        "standard input: `{}` is in {}, the diagnoser was trained on {}",
                        channel.name, columns[at].unit, channel.unit
                    ),
                    instead: "give the unit of the column with --columns".to_owned(),
                }
                .into());
            }
            Ok(at)
        };
        let inputs = interface.inputs.iter().map(place).collect::<miette::Result<Vec<_>>>()?;
        let watched = place(&interface.output)?;
        let mut u = vec![0.0; inputs.len()];
        let mut last = None;
        loop {
            interrupt::check()?;
            let Some(row) = rows.next_row().map_err(told)? else { break };
            let (line, time) = (row.line, row.time_s);
            u.iter_mut().zip(&inputs).for_each(|(u, at)| *u = row.values[*at]);
            let y = row.values[watched];
            if let Some(before) = last.replace(time) {
                let (expected, found) = (interface.period_s, time - before);
                if (found - expected).abs() > SAME_PERIOD * expected {
                    return Err(Failure::Usage {
                        what: format!(
                            "standard input, line {line}: {found} s after the row before, the \
                             diagnoser was trained on {expected} s"
                        ),
                        instead: "give rows at that sampling time".to_owned(),
                    }
                    .into());
                }
            }
            for method in watch.step(&u, y, time)? {
                if method == self.method.into() && !session.prints_json() {
                    output::print(&format!("fault declared at {time} s (line {line})\n"))?;
                } else {
                    session.remark(format_args!("{}: declared at {time} s", method.label()));
                }
            }
        }
        Ok(watch)
    }
}

fn text(answer: &Answer) -> String {
    let judged = answer.samples - answer.run_up;
    let mut text =
        format!("{}: {} samples, of which {judged} are judged\n", answer.recording, answer.samples);
    for Found { method, beta, outside, declared, .. } in &answer.methods {
        let share = 100.0 * *outside as f64 / judged as f64;
        let designed =
            beta.map_or_else(String::new, |beta| format!(" (healthy: {} %)", 100.0 * beta));
        let times: Vec<String> =
            declared.iter().map(|at| format!("{:.3} s (sample {})", at.time, at.sample)).collect();
        let declared = match times.is_empty() {
            true => "no fault declared".to_owned(),
            false => format!("declared at {}", times.join(", ")),
        };
        text += &format!("{}: {share:.2} % outside{designed}, {declared}\n", method.label());
    }
    text + &format!("verdict ({}): {}\n", answer.method.label(), answer.verdict)
}
