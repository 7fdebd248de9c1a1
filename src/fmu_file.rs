//! A drive as an `.fmu` file: description, the library that the program carries, drive file.

use std::path::Path;

use drivescope_fmu::archive::{Archive, Platform};
use drivescope_fmu::description::Version;
use drivescope_fmu::export::Model;
use drivescope_fmu_blocks::{DRIVE_FILE, DriveModel, OPEN_LOOP_FILE};
use drivescope_plant::drive::Drive;

use crate::failure::{Failure, told};
use crate::interrupt;

/// The shared library of exported drives, for the platform of this program (see `build.rs`).
const LIBRARY: &[u8] = include_bytes!(env!("DRIVESCOPE_FMU_LIBRARY"));

/// What was written.
#[derive(Debug)]
pub(crate) struct Written {
    /// Folder of the platform inside the FMU.
    pub(crate) folder: &'static str,
    /// Variables of the FMU.
    pub(crate) variables: usize,
    /// Its continuous states.
    pub(crate) states: usize,
    /// Size of the file.
    pub(crate) bytes: u64,
}

/// Writes the FMU of a drive; `open_loop` makes u an input even if the drive has a controller.
///
/// # Errors
/// A platform that FMI does not name, or a file that cannot be written.
pub(crate) fn write(
    drive: &Drive,
    open_loop: bool,
    version: Version,
    path: &Path,
) -> miette::Result<Written> {
    let Some(platform) = Platform::host() else {
        let what = "FMI has no name for this platform, so nothing could load the FMU".to_owned();
        let instead = "export on Linux, Windows or macOS, on x86_64 or aarch64".to_owned();
        return Err(Failure::Usage { what, instead }.into());
    };
    let text = drive.to_toml();
    let mut resources = vec![(DRIVE_FILE.to_owned(), text.as_bytes())];
    if open_loop {
        resources.push((OPEN_LOOP_FILE.to_owned(), &b""[..]));
    }
    let description = DriveModel::new(drive.clone(), open_loop).description();
    let archive = Archive {
        description: &description,
        libraries: vec![(platform, LIBRARY)],
        resources,
        documentation: Vec::new(),
    };
    let _not_now = interrupt::writing();
    archive.write(version, path).map_err(told)?;
    let size = std::fs::metadata(path);
    let size = size.map_err(|source| Failure::Read { path: path.to_owned(), source })?;
    Ok(Written {
        folder: platform.folder(version),
        variables: description.variables.len(),
        states: description.states().len(),
        bytes: size.len(),
    })
}
