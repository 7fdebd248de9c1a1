//! A drive as an `.fmu` file: description, embedded library, drive file.

use std::io::Write;
use std::path::Path;

use drivescope_fmu::archive::{Archive, Platform};
use drivescope_fmu::description::{ModelDescription, Version};
use drivescope_fmu::export::Model;
use drivescope_fmu_blocks::{DRIVE_FILE, DriveModel, OPEN_LOOP_FILE};
use drivescope_plant::drive::Drive;

use crate::failure::{Failure, told};
use crate::output;

/// The shared library of this platform, built with the program (see `build.rs`).
const LIBRARY: &[u8] = include_bytes!(env!("DRIVESCOPE_FMU_LIBRARY"));

/// The platform of this program, for which its FMUs are.
///
/// # Errors
/// FMI has no name for it.
pub(crate) fn platform() -> Result<Platform, Failure> {
    Platform::host().ok_or(Failure::Platform)
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
    let platform = platform()?;
    let text = drive.to_toml();
    let mut resources = vec![(DRIVE_FILE.to_owned(), text.as_bytes())];
    if open_loop {
        resources.push((OPEN_LOOP_FILE.to_owned(), b"u is an input\n".as_slice()));
    }
    let description = DriveModel::new(drive.clone(), open_loop).description();
    let archive = Archive {
        description: &description,
        libraries: vec![(platform, LIBRARY)],
        resources,
        documentation: Vec::new(),
    };
    let bytes = archive.to_bytes(version).map_err(told)?;
    output::write_file(path, |out| out.write_all(&bytes))?;
    Ok(description)
}
