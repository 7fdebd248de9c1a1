//! `export`: a drive or a diagnoser as an FMU, with the shared library that this program carries.

use std::path::{Path, PathBuf};

use clap::Args;
use drivescope_diagnoser::Diagnoser;
use drivescope_fmu::description::Version;
use drivescope_fmu_blocks::DiagnoserError;
use serde::Serialize;

use super::diagnose::{read_for, refused};
use super::{RecordingOptions, Run};
use crate::drive_source;
use crate::failure::{Ending, Failure, into_report};
use crate::fmu_file::{self, NoFmu};
use crate::next::Next;
use crate::session::Session;

/// Write a drive as a self-contained FMU, Co-Simulation and Model Exchange in one; or a diagnoser, for
/// Co-Simulation: its inputs are the signals that it was trained on, its outputs residuals, bands and
/// decisions.
///
/// The FMU runs on the platform of this program and needs neither this program nor a compiler.
#[derive(Debug, Args)]
pub(crate) struct Export {
    /// Drive file, built-in drive (`dr300`, `emps`), or diagnoser file as `train` writes it.
    #[arg(value_name = "DRIVE|DIAGNOSER")]
    drive: String,
    /// FMU to write (.fmu).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Version of the FMI standard.
    #[arg(long, value_name = "2|3", default_value_t = 3, value_parser = clap::value_parser!(u8).range(2..=3))]
    fmi: u8,
    /// Make u an input even if the drive has a controller.
    #[arg(long)]
    open_loop: bool,
    /// Of a diagnoser: a short healthy recording of the machine that the FMU will watch, to be stored
    /// in it. Without one a bank learns the machine from the first seconds of every run.
    #[arg(long, value_name = "REC", conflicts_with = "open_loop")]
    baseline: Option<PathBuf>,
    #[command(flatten)]
    reading: RecordingOptions,
}

#[derive(Debug, Serialize)]
struct Exported {
    /// Name of the drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    drive: Option<String>,
    /// The diagnoser file.
    #[serde(skip_serializing_if = "Option::is_none")]
    diagnoser: Option<PathBuf>,
    output: PathBuf,
    fmi: u8,
    #[serde(skip_serializing_if = "Option::is_none")]
    open_loop: Option<bool>,
    /// Time from which a machine is learned at the start of a run, s; none where it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    learns_for: Option<f64>,
    platform: &'static str,
    bytes: u64,
    variables: usize,
    states: usize,
}

impl Run for Export {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        if self.output.extension().is_some_and(|it| !it.eq_ignore_ascii_case("fmu")) {
            return Err(Failure::Usage {
                what: format!("{}: no tool takes an FMU of that name", self.output.display()),
                instead: "name it .fmu".to_owned(),
            }
            .into());
        }
        let path = PathBuf::from(&self.drive);
        let is_diagnoser = std::fs::read_to_string(&path).is_ok_and(|it| Diagnoser::is_meant(&it));
        let version = fmu_file::version(self.fmi);
        if is_diagnoser {
            return self.diagnoser(&path, version, session);
        }
        if self.baseline.is_some() {
            return Err(Failure::Usage {
                what: format!("{}: --baseline belongs to a diagnoser, this is a drive", self.drive),
                instead: "leave it out, or name a diagnoser file".to_owned(),
            }
            .into());
        }
        let drive = drive_source::drive(&self.drive)?;
        session.check_writable(&[&self.output])?;
        let open_loop = self.open_loop || drive.controller.is_none();
        let description = fmu_file::write(&drive, open_loop, version, &self.output)?;
        let shape = if open_loop { "open loop, input u" } else { "closed loop, input reference" };
        let shown = format!(
            "{}, FMI {}.0, Co-Simulation and Model Exchange, {shape}",
            drive.name, self.fmi
        );
        let answer = Exported {
            drive: Some(drive.name),
            open_loop: Some(open_loop),
            states: description.states().len(),
            ..self.answer(description.variables.len(), version)?
        };
        say(&shown, &answer, session)
    }
}

impl Export {
    fn diagnoser(self, path: &Path, version: Version, session: &Session) -> miette::Result<Ending> {
        if self.open_loop {
            return Err(Failure::Usage {
                what: format!(
                    "{}: --open-loop belongs to a drive, this is a diagnoser",
                    self.drive
                ),
                instead: "leave it out".to_owned(),
            }
            .into());
        }
        let diagnoser = Diagnoser::load(path).map_err(into_report)?;
        session.check_writable(&[&self.output])?;
        let file = self.baseline.as_ref();
        let baseline = file.map(|file| read_for(&diagnoser, file, &self.reading, session));
        let baseline = baseline.transpose()?;
        let made = fmu_file::write_diagnoser(&diagnoser, baseline.as_ref(), version, &self.output);
        let (description, learns_for) = made.map_err(|error| match error {
            NoFmu::Diagnoser(DiagnoserError::Monitor(error)) => refused(path, &error).into(),
            other => other.into_report(),
        })?;
        let machine = match (learns_for, &baseline) {
            (Some(s), _) => format!("the machine is learned from the first {s} s of a run"),
            (None, Some(baseline)) => format!("the machine is that of {}", baseline.name),
            (None, None) => "for any machine of its kind".to_owned(),
        };
        let shown = format!("{}, FMI {}.0, Co-Simulation, {machine}", description.name, self.fmi);
        let answer = Exported {
            diagnoser: Some(path.to_owned()),
            learns_for,
            ..self.answer(description.variables.len(), version)?
        };
        say(&shown, &answer, session)
    }

    /// What every FMU has.
    fn answer(&self, variables: usize, version: Version) -> miette::Result<Exported> {
        let unread = |source| Failure::Read { path: self.output.clone(), source };
        let bytes = std::fs::metadata(&self.output).map_err(unread)?.len();
        Ok(Exported {
            drive: None,
            diagnoser: None,
            output: self.output.clone(),
            fmi: self.fmi,
            open_loop: None,
            learns_for: None,
            platform: fmu_file::platform()?.folder(version),
            bytes,
            variables,
            states: 0,
        })
    }
}

fn say(what: &str, answer: &Exported, session: &Session) -> miette::Result<Ending> {
    let Exported { output, platform, bytes, variables, states, .. } = answer;
    let shown = format!(
        "{}: {what}\n\
         {variables} variables, {states} continuous states, {} kB\n\
         It runs on this platform only ({platform}), without drivescope.\n",
        output.display(),
        bytes / 1000,
    );
    let next = Next::new("fmu validate").files([output]);
    session.wrote(&shown, answer, &next)?;
    Ok(Ending::Done)
}
