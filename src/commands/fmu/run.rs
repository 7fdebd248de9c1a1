//! `fmu run`: one FMU over one experiment.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use drivescope_fmu::import::{Fmu, Kind, RunOptions, Value, run};
use serde::Serialize;

use crate::commands::Run;
use crate::commands::recording_options::RecordingOptions;
use crate::failure::{Ending, told};
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
    /// Stop time, s; by default the FMU's own, or the end of the input.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    stop: Option<f64>,
    /// Communication step, s; by default the FMU's own, or the sampling time of the input.
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Interface: Co-Simulation, or Model Exchange integrated by drivescope.
    #[arg(long, value_name = "cs|me", hide_possible_values = true)]
    kind: Option<Interface>,
    /// Set a parameter or start value before the run; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
    #[command(flatten)]
    reading: RecordingOptions,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Interface {
    Cs,
    Me,
}

#[derive(Debug, Serialize)]
struct Answer {
    name: String,
    output: PathBuf,
    samples: usize,
    start: f64,
    period: f64,
    signals: Vec<String>,
}

/// `NAME=VALUE`; names of FMU variables may hold nearly anything but not `=`.
fn assignment(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE")?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

impl Run for RunFmu {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let fmu = Fmu::open(&self.file).map_err(told)?;
        session.check_writable(&[&self.output])?;
        let input = self.input.as_ref().map(|path| self.reading.read(path, session));
        let input = input.transpose()?.map(|(recording, _)| recording);
        let kind = self.kind.map(|kind| match kind {
            Interface::Cs => Kind::CoSimulation,
            Interface::Me => Kind::ModelExchange,
        });
        let parameters =
            self.set.iter().map(|(name, value)| (name.clone(), Value::Text(value.clone())));
        let options = RunOptions {
            input: input.as_ref(),
            stop: self.stop,
            step: self.step,
            kind,
            parameters: parameters.collect(),
            ..RunOptions::default()
        };
        let recording = run(&fmu, &options).map_err(told)?;
        output::write_recording(&self.output, &recording)?;
        let (samples, period) = (recording.len(), recording.period_s);
        let output = self.output.clone();
        let text = format!(
            "{}: {samples} samples every {period} s: {}\n",
            recording.name,
            output.display()
        );
        let signals = recording.signals.iter().map(|signal| signal.header()).collect();
        let start = recording.start_s;
        let answer = Answer { name: recording.name, output, samples, start, period, signals };
        session.answer(&text, &answer)?;
        Ok(Ending::Done)
    }
}
