//! How a recording is read: the options of every command that takes one.

use std::path::{Path, PathBuf};

use clap::Args;
use drivescope_recording::{Mapping, ReadOptions, Recording, Report, Suspicion, read, rounded};

use crate::failure::{Failure, into_report};
use crate::next::Next;
use crate::session::Session;

/// Options of reading a recording.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Reading the recording")]
pub(crate) struct RecordingOptions {
    /// Columns by name: `u=Voltage,omega=Speed:rpm`. Kept in a small file beside the recording and
    /// used by later commands.
    #[arg(long, value_name = "NAME=COLUMN[:UNIT],..")]
    columns: Option<String>,
    /// Interpolate to this sampling time, s, in place of the one that the rows show.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    resample: Option<f64>,
    /// Sampling time of the rows, s, of a recording without a time that can be used.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    rows_every: Option<f64>,
}

impl RecordingOptions {
    /// The columns that were named.
    pub(crate) fn columns(&self) -> Option<&str> {
        self.columns.as_deref()
    }

    /// The sampling time that was asked for, s.
    pub(crate) fn resample(&self) -> Option<f64> {
        self.resample
    }

    /// A command with these options.
    pub(crate) fn on(&self, next: Next) -> Next {
        let next = self.columns.iter().fold(next, |it, said| it.options(" --columns").with(said));
        let next = self.resample.iter().fold(next, |it, s| it.options(" --resample").with(s));
        self.rows_every.iter().fold(next, |it, s| it.options(" --rows-every").with(s))
    }

    /// Whether the command line says how to read.
    fn is_said(&self) -> bool {
        self.columns.is_some() || self.resample.is_some() || self.rows_every.is_some()
    }

    /// What was said, as the command line would say it.
    pub(crate) fn new(
        columns: Option<&str>,
        resample: Option<f64>,
        rows_every: Option<f64>,
    ) -> Self {
        Self { columns: columns.map(str::to_owned), resample, rows_every }
    }

    /// What was said, where nothing was kept.
    ///
    /// # Errors
    /// A mapping of columns that is none.
    pub(crate) fn said(&self) -> miette::Result<ReadOptions> {
        let columns = self.columns.as_deref().map(Mapping::parse_list).transpose();
        let columns = columns.map_err(into_report)?.unwrap_or_default();
        Ok(ReadOptions {
            columns,
            resample: self.resample,
            rows_every: self.rows_every,
            ..ReadOptions::default()
        })
    }

    /// What the command line says, or else what was said before of this recording; then the file
    /// that keeps it.
    pub(crate) fn options(&self, path: &Path) -> miette::Result<(ReadOptions, Option<PathBuf>)> {
        let said =
            self.columns.as_deref().map(Mapping::parse_list).transpose().map_err(into_report)?;
        let kept = match said {
            // Columns that are named anew are all that counts.
            Some(_) => None,
            None => ReadOptions::kept(path).map_err(into_report)?,
        };
        let kept_at = kept.is_some().then(|| ReadOptions::kept_at(path));
        let kept = kept.unwrap_or_default();
        let options = ReadOptions {
            columns: said.unwrap_or(kept.columns),
            resample: self.resample.or(kept.resample),
            rows_every: self.rows_every.or(kept.rows_every),
            ..ReadOptions::default()
        };
        Ok((options, kept_at))
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
        let (recording, report) = self.opened(path, session, false)?;
        Ok(remarked(recording, report, session))
    }

    /// As [`Self::read`], where the signals are those of any model: what would deserve attention in a
    /// drive's is not said of them.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(crate) fn read_of_model(
        &self,
        path: &Path,
        session: &Session,
    ) -> miette::Result<Recording> {
        Ok(self.opened(path, session, true)?.0)
    }

    /// As [`Self::read`], for a model of the machine: two units that exclude each other would make
    /// it a wrong one.
    ///
    /// # Errors
    /// As [`Self::read`], and units that contradict the values.
    pub(crate) fn read_for_model(
        &self,
        path: &Path,
        session: &Session,
    ) -> miette::Result<(Recording, Report)> {
        let (recording, report) = self.opened(path, session, false)?;
        match report.suspicions.iter().find_map(|it| contradiction(&report, it)) {
            Some(failure) => Err(failure.into()),
            None => Ok(remarked(recording, report, session)),
        }
    }

    fn opened(
        &self,
        path: &Path,
        session: &Session,
        of_model: bool,
    ) -> miette::Result<(Recording, Report)> {
        if let Some(handed_over) = session.recording(path) {
            return Ok(handed_over);
        }
        let (options, kept_at) = self.options(path)?;
        let options = ReadOptions { of_model, ..options };
        if let Some(file) = kept_at {
            session.remark(format_args!("columns as kept in {}", file.display()));
        }
        let found = read(path, &options).map_err(into_report)?;
        if self.is_said() {
            session.keep_later(path, options);
        }
        Ok(found)
    }
}

/// Departure of a sampling time from another that is resampled away: rows with jitter have one of
/// their own in every file.
const NEAR: f64 = 0.1;
/// Departure that is none: printed times are rounded.
const SAME: f64 = 1e-4;

/// The recording at a sampling time to which its own is near, with what its own was, s, where it had to
/// be resampled; one of another rate is left as it is, to be refused with its name.
///
/// # Errors
/// A recording that cannot be resampled.
pub(crate) fn resampled_near(
    recording: Recording,
    period_s: f64,
) -> miette::Result<(Recording, Option<f64>)> {
    let own_s = recording.period_s;
    // Not a number either way is neither near nor the same.
    if !(SAME..NEAR).contains(&(own_s / period_s - 1.0).abs()) {
        return Ok((recording, None));
    }
    Ok((recording.resample(period_s).map_err(into_report)?, Some(own_s)))
}

/// The recording at the sampling time that a diagnoser has, where its own is near.
///
/// # Errors
/// As of [`resampled_near`].
pub(crate) fn at_period(
    recording: Recording,
    period_s: f64,
    session: &Session,
) -> miette::Result<Recording> {
    let (recording, from_s) = resampled_near(recording, period_s)?;
    if let Some(from_s) = from_s {
        session.remark(format_args!(
            "{}: resampled from {} s to the diagnoser's {} s",
            recording.name,
            rounded(from_s),
            rounded(period_s)
        ));
    }
    Ok(recording)
}

/// Says what was assumed and what deserves attention.
fn remarked(recording: Recording, report: Report, session: &Session) -> (Recording, Report) {
    for remark in report.guesses().iter().chain(&report.warnings()) {
        session.remark(format_args!("{}: {remark}", report.file));
    }
    (recording, report)
}

/// What to say of units that exclude each other.
fn contradiction(report: &Report, suspicion: &Suspicion) -> Option<Failure> {
    let Suspicion::Ratio { signal, with, ratio, meaning: Some(meaning), .. } = suspicion else {
        return None;
    };
    let column = |signal: &str| {
        let note = report.columns.iter().find(|note| note.signal == signal);
        note.map_or_else(|| signal.to_owned(), |note| note.column.clone())
    };
    suspicion.is_contradiction().then(|| Failure::Usage {
        what: format!("{}: {signal} is {ratio:.4} times what {with} says: {meaning}", report.file),
        instead: format!(
            "say the unit of one with --columns {signal}={}:UNIT, or keep the other out with \
             --columns {with}_unused={}",
            column(signal),
            column(with)
        ),
    })
}
