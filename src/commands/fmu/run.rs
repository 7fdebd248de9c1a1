//! `fmu run`: one FMU over one experiment.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use drivescope_fmu::import::{Fmu, Interface, Ran, RunOptions, Status, Value, run};
use drivescope_recording::rounded;
use serde::Serialize;

use crate::commands::Run;
use crate::commands::recording_options::RecordingOptions;
use crate::failure::{Ending, into_report};
use crate::next::Next;
use crate::output;
use crate::session::Session;

/// Run an FMU and write a recording of its inputs and outputs.
#[derive(Debug, Args)]
pub(crate) struct RunFmu {
    /// The FMU.
    file: PathBuf,
    /// Recording to write (.csv).
    #[arg(short, long, value_name = "REC")]
    output: PathBuf,
    /// Drive the inputs by the signals of the same names, held between samples.
    #[arg(long, value_name = "REC")]
    input: Option<PathBuf>,
    /// Start time, s; by default the FMU's own, or 0.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    start: Option<f64>,
    /// Stop time, s; by default the FMU's own, or the end of the input.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Communication step, s; by default the FMU's own, or the sampling time of the input.
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Relative tolerance of the integration; by default the FMU's own.
    #[arg(long, value_name = "T")]
    tolerance: Option<f64>,
    /// Interface: Co-Simulation, or Model Exchange integrated by drivescope.
    #[arg(long, value_name = "cs|me", hide_possible_values = true)]
    kind: Option<InterfaceName>,
    /// Record this variable and not all outputs; may be given several times.
    #[arg(long, value_name = "NAME")]
    record: Vec<String>,
    /// Show all that the FMU logs, not warnings and errors alone.
    #[arg(long)]
    log: bool,
    /// Set a parameter or start value before the run, the elements of an array parted by blanks; may
    /// be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
    #[command(flatten)]
    reading: RecordingOptions,
}

/// Share of the step within which two times are the same.
const SAME_POINT: f64 = 1e-6;

#[derive(Debug, Clone, Copy, ValueEnum)]
enum InterfaceName {
    Cs,
    Me,
}

#[derive(Debug, Serialize)]
struct RunAnswer {
    name: String,
    output: PathBuf,
    samples: usize,
    start: f64,
    period: f64,
    /// When the FMU ended the run, if it did, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    ended: Option<f64>,
    signals: Vec<String>,
}

/// `NAME=VALUE`; names of FMU variables may hold nearly anything but not `=`.
fn assignment(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE")?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

impl Run for RunFmu {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let fmu = Fmu::open(&self.file).map_err(into_report)?;
        session.check_writable(&[&self.output])?;
        let input = self.input.as_ref().map(|path| self.reading.read_of_model(path, session));
        let input = input.transpose()?;
        let kind = self.kind.map(|kind| match kind {
            InterfaceName::Cs => Interface::CoSimulation,
            InterfaceName::Me => Interface::ModelExchange,
        });
        let parameters =
            self.set.iter().map(|(name, value)| (name.clone(), Value::Text(value.clone())));
        let options = RunOptions {
            input: input.as_ref(),
            start: self.start,
            stop: self.stop,
            step: self.step,
            tolerance: self.tolerance,
            kind,
            parameters: parameters.collect(),
            record: (!self.record.is_empty()).then(|| self.record.clone()),
            // What an FMU says of something wrong it may say only when it logs.
            logging: true,
        };
        let Ran { recording, texts, ended, left_out, messages } =
            run(&fmu, &options).map_err(into_report)?;
        for message in messages.iter().filter(|message| {
            self.log || !message.status.is_good() || message.status == Status::Warning
        }) {
            session.remark(format_args!("{}: {}", fmu.name(), message.text));
        }
        if !left_out.is_empty() {
            let names = left_out.join(", ");
            session.remark(format_args!("not recorded, as clocks hold no value: {names}"));
        }
        output::write_with_texts(&self.output, &recording, &texts)?;
        let samples = texts.first().map_or(recording.len(), |text| text.values.len());
        let (start, period) = (recording.start_s, recording.period_s);
        let output = self.output.clone();
        let mut text = format!(
            "{}: {samples} samples every {} s: {}\n",
            recording.name,
            rounded(period),
            output.display()
        );
        let last = start + samples.saturating_sub(1) as f64 * period;
        if let Some(ended) = ended {
            text += &format!("the FMU ended the run at {} s\n", rounded(ended));
        } else if let Some(stop) = self.stop.filter(|stop| stop - last > SAME_POINT * period) {
            let (last, stop) = (rounded(last), rounded(stop));
            text += &format!("the last whole step ends at {last} s, before the stop at {stop} s\n");
        }
        let signals = recording.signals.iter().map(|signal| signal.header());
        let signals = signals.chain(texts.into_iter().map(|text| text.name)).collect();
        let answer =
            RunAnswer { name: recording.name, output, samples, start, period, ended, signals };
        session.wrote(&text, &answer, &Next::new("serve").files([&self.output]))?;
        Ok(Ending::Done)
    }
}
