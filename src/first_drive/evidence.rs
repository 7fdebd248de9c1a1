//! A recording as evidence for a first drive.

use drivescope_discovery::{Evidence, Measured, noise};
use drivescope_plant::drive::Drive;
use drivescope_recording::Recording;

use crate::failure::into_report;

/// The recording as that drive's, with the noise of its outputs.
pub(super) fn seen(drive: &Drive, recording: &Recording) -> miette::Result<Evidence> {
    let measured = Measured::new(drive, recording).map_err(into_report)?;
    let sds = noise(drive, &measured, &[]).iter().map(|it| it.sd).collect();
    Ok(Evidence { recordings: vec![measured], noise: vec![sds] })
}
