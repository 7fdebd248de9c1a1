//! What a file holds.

use std::path::Path;

use drivescope_recording::{Preview, ReadOptions, Recording, Report, read_with_preview};

use crate::failure::into_report;
use crate::page::incomplete::Incomplete;
use crate::page::plain::plain;

/// What a file holds.
#[derive(Debug, Default)]
pub(super) struct Content {
    pub(super) recording: Option<Recording>,
    pub(super) report: Option<Report>,
    pub(super) preview: Option<Preview>,
    pub(super) incomplete: Option<Incomplete>,
}

/// Reads the file; what is said of it names what the user called it.
pub(super) fn read_named(
    path: &Path,
    name: &str,
    options: &ReadOptions,
) -> Result<Content, String> {
    let own = path.display().to_string();
    let said = |error| plain(&into_report(error).to_string()).replace(&own, name);
    let (preview, read) = read_with_preview(path, options).map_err(said)?;
    match read {
        Ok((mut recording, mut report)) => {
            name.clone_into(&mut recording.name);
            name.clone_into(&mut report.file);
            let (recording, report, preview) = (Some(recording), Some(report), Some(preview));
            Ok(Content { recording, report, preview, incomplete: None })
        }
        Err(error) => match Incomplete::of(&error, &preview) {
            None => Err(said(error)),
            incomplete => Ok(Content { incomplete, preview: Some(preview), ..Content::default() }),
        },
    }
}
