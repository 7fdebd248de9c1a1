//! Drives and recordings as a caller holds them: read, checked and written as commands do.

use std::path::Path;

use drivescope_recording::{Recording, Report};

use super::{Refused, guarded};
use crate::commands::RecordingOptions;
use crate::failure::into_report;
use crate::{drive_source, output};

/// The text of a drive file, or of a built-in drive, and what the drive is called.
///
/// # Errors
/// What is wrong with it and where.
pub fn drive(given: &str) -> Result<(String, String), Refused> {
    guarded(|| {
        let text = drive_source::text(given)?;
        let drive = drive_source::parse(&text, given)?;
        Ok((text, drive.name))
    })
}

/// What the drive of that text is called; `name` is what messages call the text.
///
/// # Errors
/// What is wrong with it and where.
pub fn drive_name(text: &str, name: &str) -> Result<String, Refused> {
    guarded(|| Ok(drive_source::parse(text, name)?.name))
}

/// A recording in a file, as every command reads it: with what was said of its columns before,
/// unless more is said now.
///
/// # Errors
/// What is wrong with it and where.
pub fn read(
    path: &Path,
    (columns, resample, rows_every): (Option<&str>, Option<f64>, Option<f64>),
) -> Result<(Recording, Report), Refused> {
    guarded(|| {
        let (options, _) = RecordingOptions::new(columns, resample, rows_every).options(path)?;
        drivescope_recording::read(path, &options).map_err(into_report)
    })
}

/// A recording of columns in memory, each with the text that would stand above it in a file of that
/// name.
///
/// # Errors
/// What is wrong with it and where.
pub fn of_columns(
    name: &str,
    signals: Vec<(String, Vec<f64>)>,
    (columns, resample, rows_every): (Option<&str>, Option<f64>, Option<f64>),
) -> Result<(Recording, Report), Refused> {
    guarded(|| {
        let options = RecordingOptions::new(columns, resample, rows_every).said()?;
        drivescope_recording::of_columns(name, signals, &options).map_err(into_report)
    })
}

/// A recording as a command would read it from a file of that name.
///
/// # Errors
/// What makes it unreadable.
pub fn reread(recording: Recording, name: &str) -> Result<(Recording, Report), Refused> {
    guarded(|| recording.reread(name).map_err(into_report))
}

/// Writes a recording; the file's extension tells the format.
///
/// # Errors
/// The path, where it cannot be written or its format is not known.
pub fn write(path: &Path, recording: &Recording) -> Result<(), Refused> {
    guarded(|| output::write_recording(path, recording))
}

/// A page of a recording with spans: from, to, s, and what they say.
///
/// # Errors
/// An internal error only.
pub fn page(recording: &Recording, spans: &[(f64, f64, String)]) -> Result<String, Refused> {
    guarded(|| Ok(crate::report::recording_html(recording, spans)))
}
