//! `export`: a drive as an FMU, with the shared library that this program carries.

use std::path::PathBuf;

use clap::Args;
use drivescope_fmu::description::Version;
use serde::Serialize;

use super::Run;
use crate::failure::{Ending, Failure};
use crate::next::Next;
use crate::session::Session;
use crate::{drive_source, fmu_file};

/// Write a drive as a self-contained FMU: Co-Simulation and Model Exchange in one.
///
/// The FMU runs on the platform of this program and needs neither this program nor a compiler.
#[derive(Debug, Args)]
pub(crate) struct Export {
    /// Drive file, or a built-in drive (`dr300`, `emps`).
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
}

#[derive(Debug, Serialize)]
struct Answer {
    drive: String,
    output: PathBuf,
    fmi: u8,
    open_loop: bool,
    platform: &'static str,
    bytes: u64,
    variables: usize,
    states: usize,
}

impl Run for Export {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        let drive = drive_source::drive(&self.drive)?;
        session.check_writable(&[&self.output])?;
        let version = if self.fmi == 2 { Version::Two } else { Version::Three };
        let platform = fmu_file::platform()?;
        let open_loop = self.open_loop || drive.controller.is_none();
        let description = fmu_file::write(&drive, open_loop, version, &self.output)?;
        let unread = |source| Failure::Read { path: self.output.clone(), source };
        let bytes = std::fs::metadata(&self.output).map_err(unread)?.len();
        let name = drive.name;
        let folder = platform.folder(version);
        let (variables, states) = (description.variables.len(), description.states().len());
        let output = self.output.clone();
        let shape = if open_loop { "open loop, input u" } else { "closed loop, input reference" };
        let shown = format!(
            "{}: {name}, FMI {}.0, Co-Simulation and Model Exchange, {shape}\n\
             {variables} variables, {states} continuous states, {} kB\n\
             It runs on this platform only ({folder}), without drivescope.\n",
            output.display(),
            self.fmi,
            bytes / 1000,
        );
        let fmi = self.fmi;
        let answer = Answer {
            drive: name,
            output,
            fmi,
            open_loop,
            platform: folder,
            bytes,
            variables,
            states,
        };
        let next = Next::new("fmu validate").files([&self.output]);
        session.wrote(&shown, &answer, &next)?;
        Ok(Ending::Done)
    }
}
