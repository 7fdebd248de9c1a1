//! `compare`: a model against recordings of its drive, and where it fails.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use drivescope_discovery::compare::{
    Comparison, Curve, Finding, Options, RecordingComparison, Span, compare,
};
use drivescope_discovery::signals::SignalFinding;
use drivescope_discovery::{
    Observer, Purpose, Setting, USUAL_BAND_HZ, evaluate, relative_force_error,
};
use drivescope_plant::drive::Motion;
use drivescope_plant::units::for_motion;
use serde::Serialize;
use serde_json::Value;

use super::{RecordingOptions, Run};
use crate::failure::{Ending, told};
use crate::next::Next;
use crate::read_evidence::{ReadEvidence, given_noise, read_evidence, unusable};
use crate::report::compare::{self as page, compare_html};
use crate::report::words::{fit_percent, p_value, significant};
use crate::session::Session;
use crate::{drive_source, output};

/// Compare a drive's model with recordings: how well it fits, and where and when it fails.
#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// Drive file, or a built-in drive (`dr300`, `emps`).
    drive: String,
    /// Recordings of one machine: the same signals and sampling time.
    #[arg(required = true, value_name = "REC")]
    recordings: Vec<PathBuf>,
    /// Further recordings, of which only the error is told.
    #[arg(long, value_name = "REC", num_args = 1..)]
    validate: Vec<PathBuf>,
    /// Standard deviations of the sensors' noise, SI: `i=0.01,omega=0.3`; what is not given is
    /// taken from the drive file or estimated from the recording.
    #[arg(long, value_name = "NAME=SD,..")]
    noise: Option<String>,
    /// Report to write (.html): what is missing over each variable, in pictures.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// End with exit status 1 if the model fails over any variable.
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    reading: RecordingOptions,
}

#[derive(Debug, Serialize)]
struct Before {
    error: f64,
    validation_error: Option<f64>,
}

/// A span with its recording.
#[derive(Debug, Serialize)]
struct SpanOf<'a> {
    recording: &'a str,
    #[serde(flatten)]
    span: &'a Span,
}

#[derive(Debug, Serialize)]
struct CompareAnswer<'a> {
    drive: &'a str,
    /// What is wrong with the signals of the recordings.
    signals: &'a [SignalFinding],
    #[serde(skip)]
    motion: Motion,
    observer_hz: f64,
    noise_floor: f64,
    before: Before,
    error_if_fitted: f64,
    by_parameters: f64,
    fitted: bool,
    /// Whether its values are as good as those of least squares on the balances.
    by_balances: bool,
    /// By output, of the first recording, and `source`; each recording has its own below.
    noise: BTreeMap<&'a str, Value>,
    verdict: &'a str,
    #[serde(rename = "where")]
    findings: &'a [Finding],
    tested: usize,
    block_s: f64,
    spans: Vec<SpanOf<'a>>,
    recordings: &'a [RecordingComparison],
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_force_error: Option<f64>,
    curves: &'a [Curve],
    doubts: &'a [String],
    seed: u64,
}

impl Run for Compare {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let drive = drive_source::drive(&self.drive)?;
        session.check_writable(&self.out.iter().collect::<Vec<_>>())?;
        let given = given_noise(&drive, self.noise.as_deref())?;
        let read = |files: &[PathBuf]| {
            read_evidence((&drive, Purpose::Drive), files, &given, &self.reading, session)
        };
        let ReadEvidence { evidence, noise, mut signals, doubts } = read(&self.recordings)?;
        let validation = if self.validate.is_empty() { None } else { Some(read(&self.validate)?) };
        if let Some(it) = &validation {
            signals.extend(it.signals.iter().cloned());
        }
        let observer = Observer::choose(&drive, &evidence.recordings, &evidence.noise);
        let setting = Setting::new(&drive, observer);
        let spinner = session.spinner();
        spinner.set_message("comparing");
        let options = Options { curves: true, seed: session.seed };
        let compared = compare(&drive, &evidence, &setting, &options).map_err(told)?;
        let validation_error = validation
            .map(|it| evaluate(&drive, &it.evidence, &setting, true).map_err(told))
            .transpose()?
            .map(|judged| judged.squares.error());
        spinner.finish_and_clear();
        let verdict = page::verdict(&compared);
        let mut by_name: BTreeMap<&str, Value> = BTreeMap::new();
        for it in &noise[0] {
            by_name.insert(it.name, Value::from(it.sd));
            by_name.insert("source", serde_json::to_value(it.source).unwrap_or_default());
        }
        let spans = compared
            .recordings
            .iter()
            .flat_map(|it| it.spans.iter().map(|span| SpanOf { recording: &it.name, span }));
        let first = evidence.recordings.first();
        let answer = CompareAnswer {
            drive: &drive.name,
            signals: &signals,
            motion: drive.motion,
            observer_hz: compared.observer_hz,
            noise_floor: compared.floor,
            before: Before { error: compared.error, validation_error },
            error_if_fitted: compared.error_if_fitted,
            by_parameters: compared.by_parameters,
            fitted: !compared.is_unfitted(),
            by_balances: compared.by_balances,
            noise: by_name,
            verdict: &verdict,
            findings: &compared.findings,
            tested: compared.tested,
            block_s: compared.block_s,
            spans: spans.collect(),
            recordings: &compared.recordings,
            relative_force_error: first
                .and_then(|it| relative_force_error(&drive, it, USUAL_BAND_HZ)),
            curves: &compared.curves,
            doubts: &doubts,
            seed: session.seed,
        };
        if let Some(out) = &self.out {
            let seed = session.seed;
            let about =
                page::Setting::new(&drive, &evidence, &noise[0], validation_error, &doubts, seed);
            let html = compare_html(&compared, &about);
            output::write_file(out, |file| file.write_all(html.as_bytes()))?;
        }
        let fails = compared.fails();
        let on = |next: Next| {
            let next = next.with(&self.drive).files(&self.recordings);
            self.reading.on(next.judged(&self.validate, self.noise.as_deref()))
        };
        // Beyond the noise other values would explain more, whether or not a variable shows it.
        let next = match (compared.is_unfitted(), fails) {
            (true, shown) if shown || !page::explains(&compared) => {
                on(Next::new("fit")).options(" -o fitted.toml")
            }
            (_, true) => on(Next::new("discover")).options(" -o found.toml"),
            (_, false) => Next::new("export").with(&self.drive).options(" -o drive.fmu"),
        };
        session.say(&text(&drive.name, &compared, &answer), &answer, &next)?;
        Ok(if self.check && fails { Ending::Forbidden } else { Ending::Done })
    }
}

/// The answer for a person.
fn text(drive: &str, compared: &Comparison, answer: &CompareAnswer<'_>) -> String {
    let mut text = String::new();
    text += &unusable(answer.signals);
    let name = if drive.is_empty() { "the drive" } else { drive };
    let _ = writeln!(text, "{name}: {}", answer.verdict);
    let _ = writeln!(text, "{}", page::remark(compared, None));
    if let Some(error) = answer.before.validation_error {
        let _ = writeln!(text, "Error on the recordings of --validate: {error:.4}");
    }
    for it in &compared.recordings {
        let _ = writeln!(text, "{}: error {:.4}", it.name, it.error);
        for output in &it.outputs {
            let fit = |percent: Option<f64>| percent.map_or("constant".to_owned(), fit_percent);
            let white = if output.autocorrelation.correlated { "not white" } else { "white" };
            let input = if output.input_correlation.correlated { ", knows the input" } else { "" };
            let _ = writeln!(
                text,
                "  {:<6} fit {:>9}, one step ahead {:>9}; rms {} {}, error {:.3}; residual \
                 {white}{input}",
                output.name,
                fit(output.fit_percent),
                fit(output.one_step_percent),
                significant(output.rms, 5),
                output.unit,
                output.error
            );
        }
    }
    if !compared.findings.is_empty() {
        let unit = for_motion(answer.motion, "rad");
        let _ = writeln!(text, "where it fails       share  by chance  what it looks like");
        for it in &compared.findings {
            let period = it.period.map_or(String::new(), |it| format!(", period {it:.4} {unit}"));
            let _ = writeln!(
                text,
                "  {:<14} {:>8.1} % {:>10}  {}{period}",
                it.variable,
                100.0 * it.share,
                p_value(it.p_value),
                it.words
            );
        }
    }
    for it in &answer.spans {
        let _ = writeln!(text, "{}: {}", it.recording, it.span.sentence);
    }
    text
}
