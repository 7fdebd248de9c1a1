//! `init`: a first drive file from a recording.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use drivescope_discovery::with_canonical_names;
use drivescope_plant::drive::{Drive, Input};
use drivescope_recording::Recording;
use serde::Serialize;

use super::Run;
use super::recording_options::RecordingOptions;
use crate::failure::{Ending, told};
use crate::first_drive::{FirstDrive, Origin};
use crate::output;
use crate::session::Session;
use crate::simulation::replay::{Fit, fits, replay, start};
use crate::simulation::without_noise;

/// Make a first drive file from a recording: signals recognised, rough values, what to fill in.
#[derive(Debug, Args)]
pub(crate) struct Init {
    /// Recording of the drive.
    recording: PathBuf,
    /// Drive file to write (.toml).
    #[arg(short, long, value_name = "DRIVE")]
    output: PathBuf,
    /// What u is: the armature voltage, or a command that u x K_m turns into torque or force.
    #[arg(long, value_name = "voltage|force", hide_possible_values = true)]
    input: Option<Kind>,
    #[command(flatten)]
    reading: RecordingOptions,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    Voltage,
    Force,
}

#[derive(Debug, Serialize)]
struct Answer {
    output: PathBuf,
    motion: drivescope_plant::drive::Motion,
    input: Input,
    parameters: Vec<Parameter>,
    /// How well the file's drive reproduces the recording.
    fit: Vec<Fit>,
}

#[derive(Debug, Serialize)]
struct Parameter {
    name: &'static str,
    value: f64,
    /// Whether the recording tells it.
    estimated: bool,
    origin: &'static str,
}

impl Run for Init {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        session.check_writable(&[&self.output])?;
        let (recording, report) = self.reading.read(&self.recording, session)?;
        let needed = ["u", "i", "omega", "v", "theta", "x", "T", "I_m", "T_l"];
        let needed =
            needed.into_iter().filter(|name| *name == "u" || recording.signal(name).is_some());
        report.require(&recording, &needed.collect::<Vec<_>>()).map_err(told)?;
        let input = self.input.map(|kind| match kind {
            Kind::Voltage => Input::Voltage,
            Kind::Force => Input::Force,
        });
        let first = FirstDrive::of(&recording, input)?;
        let (text, drive) = first.file(&self.output.display().to_string())?;
        let fit = tried(&drive, recording, session)?;
        output::write_file(&self.output, |out| out.write_all(text.as_bytes()))?;
        let answer = Answer {
            output: self.output.clone(),
            motion: first.motion,
            input: first.input,
            parameters: parameters(&first),
            fit,
        };
        session.answer(&said(&first, &answer), &answer)?;
        Ok(Ending::Done)
    }
}

/// Runs the new drive on the recording that it comes from.
fn tried(drive: &Drive, recording: Recording, session: &Session) -> miette::Result<Vec<Fit>> {
    let drive = without_noise(drive);
    let measured = with_canonical_names(&drive, recording);
    let start = start(&drive, &measured)?;
    let bar = session.progress(measured.len() as u64, "trying");
    let model = replay(&drive, &measured, start, &bar)?;
    Ok(fits(&measured, &model))
}

fn parameters(first: &FirstDrive) -> Vec<Parameter> {
    let parameter = |(name, value): (&'static str, &crate::first_drive::Value)| {
        let (estimated, origin) = match value.origin {
            Origin::Estimated(how) => (true, how),
            Origin::Guessed(todo) => (false, todo),
        };
        Parameter { name, value: value.value, estimated, origin }
    };
    first.values().into_iter().map(parameter).collect()
}

fn said(first: &FirstDrive, answer: &Answer) -> String {
    let mut text = format!("{}: input u is ", answer.output.display());
    let kind = if first.input == Input::Voltage { "the voltage" } else { "a force command" };
    let _ = writeln!(text, "{kind} ({})", first.because);
    for parameter in &answer.parameters {
        let mark = if parameter.estimated { "estimated" } else { "FILL IN" };
        let _ = writeln!(text, "  {:<12} {:<12.4e} {mark}", parameter.name, parameter.value);
    }
    for (name, todo) in first.guesses() {
        let _ = writeln!(text, "fill in {name}: {todo}");
    }
    for Fit { signal, percent, .. } in &answer.fit {
        if let Some(percent) = percent {
            let _ = writeln!(text, "  {signal:<8} fit {percent:.1} % before any fitting");
        }
    }
    text
}
