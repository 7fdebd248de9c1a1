//! How a recording is read: the options of every command that takes one.

use std::path::Path;

use clap::Args;
use drivescope_recording::{Mapping, ReadOptions, Recording, Report, read};

use crate::failure::told;
use crate::session::Session;

/// Options of reading a recording.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reading the recording")]
pub(crate) struct RecordingOptions {
    /// Columns by name: `u=Voltage,omega=Speed:rpm`.
    #[arg(long, value_name = "NAME=COLUMN[:UNIT],..")]
    columns: Option<String>,
    /// Interpolate to this sampling time, s, where time is not uniform.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    resample: Option<f64>,
}

impl RecordingOptions {
    /// The columns that were named.
    pub(crate) fn columns(&self) -> Option<&str> {
        self.columns.as_deref()
    }

    /// Reads the recording and says what was assumed and what deserves attention.
    ///
    /// # Errors
    /// The file, its columns or its time axis cannot be used.
    pub(crate) fn read(
        &self,
        path: &Path,
        session: &Session,
    ) -> miette::Result<(Recording, Report)> {
        let columns = self.columns.as_deref().map(Mapping::parse_list).transpose();
        let columns = columns.map_err(told)?.unwrap_or_default();
        let options = ReadOptions { columns, resample: self.resample };
        let (recording, report) = read(path, &options).map_err(told)?;
        for remark in report.guesses().iter().chain(&report.warnings()) {
            session.remark(format_args!("{}: {remark}", report.file));
        }
        Ok((recording, report))
    }
}
