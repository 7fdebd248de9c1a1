//! `export`: a drive as an FMU, with the shared library that this program carries.

use std::path::PathBuf;

use clap::Args;
use drivescope_fmu::archive::{Archive, Platform};
use drivescope_fmu::description::{ModelDescription, Version};
use drivescope_fmu::export::Model;
use drivescope_fmu_blocks::{DRIVE_FILE, DriveModel, OPEN_LOOP_FILE};
use serde::Serialize;

use super::Run;
use crate::drive_source;
use crate::failure::{Ending, Failure, told};
use crate::interrupt;
use crate::session::Session;

/// The shared library of exported drives, for the platform of this program (see `build.rs`).
const LIBRARY: &[u8] = include_bytes!(env!("DRIVESCOPE_FMU_LIBRARY"));

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
        let Some(platform) = Platform::host() else {
            let what =
                "FMI has no name for this platform, so nothing could load the FMU".to_owned();
            let instead = "export on Linux, Windows or macOS, on x86_64 or aarch64".to_owned();
            return Err(Failure::Usage { what, instead }.into());
        };
        let text = drive.to_toml();
        let open_loop = self.open_loop || drive.controller.is_none();
        let name = drive.name.clone();
        let description = DriveModel::new(drive, open_loop).description();
        let bytes = self.write(&description, version, (platform, &text, open_loop))?;
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
        session.answer(&shown, &answer)?;
        Ok(Ending::Done)
    }
}

impl Export {
    /// Writes the archive; its size, bytes.
    fn write(
        &self,
        description: &ModelDescription,
        version: Version,
        (platform, drive, open_loop): (Platform, &str, bool),
    ) -> miette::Result<u64> {
        let mut resources = vec![(DRIVE_FILE.to_owned(), drive.as_bytes())];
        if open_loop {
            resources.push((OPEN_LOOP_FILE.to_owned(), &b""[..]));
        }
        let archive = Archive {
            description,
            libraries: vec![(platform, LIBRARY)],
            resources,
            documentation: Vec::new(),
        };
        let _not_now = interrupt::writing();
        archive.write(version, &self.output).map_err(told)?;
        let size = std::fs::metadata(&self.output);
        let size = size.map_err(|source| Failure::Read { path: self.output.clone(), source })?;
        Ok(size.len())
    }
}
