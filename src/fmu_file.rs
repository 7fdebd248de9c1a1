//! A drive or a diagnoser as an `.fmu` file: description, embedded library, the file itself.

use std::io::Write;
use std::path::Path;

use drivescope_diagnoser::Diagnoser;
use drivescope_fmu::archive::{Archive, Platform};
use drivescope_fmu::description::{ModelDescription, Version};
use drivescope_fmu::export::Model;
use drivescope_fmu_blocks::{
    BASELINE_FILE, DIAGNOSER_FILE, DRIVE_FILE, DiagnoserError, DiagnoserModel, DriveModel,
    OPEN_LOOP_FILE, baseline_text,
};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;

use crate::failure::{Failure, into_report};
use crate::output;

/// The shared libraries of this platform, built with the program (see `build.rs`).
const LIBRARY: &[u8] = include_bytes!(env!("DRIVESCOPE_FMU_LIBRARY"));
const DIAGNOSER_LIBRARY: &[u8] = include_bytes!(env!("DRIVESCOPE_FMU_DIAGNOSER_LIBRARY"));

/// The platform of this program, for which its FMUs are.
///
/// # Errors
/// FMI has no name for it.
pub(crate) fn platform() -> Result<Platform, Failure> {
    Platform::host().ok_or(Failure::Platform)
}

/// The version that the number 2 or 3 asks for.
pub(crate) fn version(fmi: u8) -> Version {
    if fmi == 2 { Version::Two } else { Version::Three }
}

/// Writes the FMU of a drive; `open_loop` makes u an input even if the drive has a controller.
/// What the FMU says of itself.
///
/// # Errors
/// A platform that FMI does not name, or a file that cannot be written.
pub(crate) fn write(
    drive: &Drive,
    open_loop: bool,
    version: Version,
    path: &Path,
) -> miette::Result<ModelDescription> {
    let text = drive.to_toml();
    let mut resources = vec![(DRIVE_FILE.to_owned(), text.as_bytes())];
    if open_loop {
        resources.push((OPEN_LOOP_FILE.to_owned(), b"u is an input\n".as_slice()));
    }
    let description = DriveModel::new(drive.clone(), open_loop).description();
    put(&description, (LIBRARY, resources), version, path)?;
    Ok(description)
}

/// Why there is no FMU of a diagnoser.
#[derive(Debug)]
pub(crate) enum NoFmu {
    /// The diagnoser, or what is watched with it, does not serve.
    Diagnoser(DiagnoserError),
    /// It cannot be written.
    Written(miette::Report),
}

impl NoFmu {
    /// In words for a person.
    pub(crate) fn into_report(self) -> miette::Report {
        match self {
            Self::Diagnoser(error) => into_report(error),
            Self::Written(error) => error,
        }
    }
}

/// Writes the FMU of a diagnoser; with a baseline, the machine is known from the start of a run.
/// What the FMU says of itself.
///
/// # Errors
/// A baseline that does not serve, a platform that FMI does not name, or a file that cannot be
/// written.
pub(crate) fn write_diagnoser(
    diagnoser: &Diagnoser,
    baseline: Option<&Recording>,
    version: Version,
    path: &Path,
) -> Result<(ModelDescription, Option<f64>), NoFmu> {
    let other = |error: miette::Report| NoFmu::Written(error);
    let model = DiagnoserModel::new(diagnoser.clone(), baseline.cloned());
    let model = model.map_err(NoFmu::Diagnoser)?;
    let description = model.description();
    let text = diagnoser.to_toml().map_err(|error| other(into_report(error)))?;
    let names: Vec<&str> = description.variables.iter().map(|it| it.name.as_str()).collect();
    let of_baseline = baseline.map(|baseline| baseline_text(baseline, &names)).transpose();
    let of_baseline = of_baseline.map_err(|error| other(into_report(error)))?;
    let mut resources = vec![(DIAGNOSER_FILE.to_owned(), text.as_bytes())];
    let stored = of_baseline.iter().map(|text| (BASELINE_FILE.to_owned(), text.as_bytes()));
    resources.extend(stored);
    put(&description, (DIAGNOSER_LIBRARY, resources), version, path).map_err(NoFmu::Written)?;
    Ok((description, model.learns_for()))
}

fn put(
    description: &ModelDescription,
    (library, resources): (&[u8], Vec<(String, &[u8])>),
    version: Version,
    path: &Path,
) -> miette::Result<()> {
    let libraries = vec![(platform()?, library)];
    let archive = Archive { description, libraries, resources, documentation: Vec::new() };
    let bytes = archive.to_bytes(version).map_err(into_report)?;
    Ok(output::write_file(path, |out| out.write_all(&bytes))?)
}
