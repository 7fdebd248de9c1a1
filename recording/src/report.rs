//! What reading a recording brought to light: guesses, sampling, holes, limits, steps, doubts.

use std::fmt;

use serde::Serialize;

use crate::error::{Error, digits};
use crate::header::{ColumnNote, Taken};
use crate::place::{Counted, Place};
use crate::quality::SignalQuality;
use crate::rounded::rounded;
use crate::signal::Recording;
use crate::stretches::Stretches;
use crate::suspicion::Suspicion;

/// How the recording is sampled, and what was done to the file's rows to get there.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Sampling {
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Sampling time, s.
    pub period_s: f64,
    /// Largest departure of the stamps from their grid (of uniform ones, of a step from the mean),
    /// in steps.
    pub jitter: f64,
    /// Sampling time of the file, s, where the user asked for another.
    pub resampled_from_s: Option<f64>,
    /// Whether the stamps were not uniform within 1 %.
    pub uneven: bool,
    /// Whether values were interpolated at their stamps; otherwise rows are samples, one by one.
    pub by_stamps: bool,
    /// Largest departure of a stamp from its place on the grid, s.
    pub largest_shift_s: f64,
    /// Share of the samples that lie between rows.
    pub interpolated: f64,
    /// Segments of the recording.
    pub segments: usize,
    /// Segments whose clock ran back and that were moved behind the one before.
    pub moved: usize,
    /// Rows that stood in disorder and were sorted.
    pub disordered: usize,
    /// Rows that were left out because nothing stands beside them.
    pub stray: usize,
}

impl Sampling {
    /// Samples as a file gives them without a time column.
    pub(crate) fn plain(start_s: f64, period_s: f64) -> Self {
        Self { start_s, period_s, segments: 1, ..Self::default() }
    }

    /// What was done to time, in one line; nothing where it was uniform.
    fn line(&self, gaps: usize) -> Option<String> {
        let mut done = Vec::new();
        if self.uneven {
            let (shift, period) = (digits(self.largest_shift_s), digits(self.period_s));
            done.push(format!("stamps up to {shift} s off a uniform grid of {period} s"));
            done.push(match self.by_stamps {
                true => "values interpolated at their stamps".to_owned(),
                false => "rows taken as evenly sampled".to_owned(),
            });
        }
        if let Some(from_s) = self.resampled_from_s {
            let (from, to) = (digits(from_s), rounded(self.period_s));
            done.push(format!("resampled from {from} s to {to} s"));
        }
        if self.interpolated > 0.0 {
            let share = 100.0 * self.interpolated;
            done.push(format!("{share:.2} % of the samples between rows"));
        }
        if self.disordered > 0 {
            done.push(format!("{} rows in disorder sorted", self.disordered));
        }
        if self.stray > 0 {
            done.push(format!("{} rows that stand alone left out", self.stray));
        }
        if self.segments > 1 {
            done.push(format!(
                "{gaps} breaks: {} segments, each with its own start",
                self.segments
            ));
        }
        if self.moved > 0 {
            let times = if self.moved == 1 { "once" } else { "several times" };
            done.push(format!("the clock runs back {times}: what follows is set behind"));
        }
        (!done.is_empty()).then(|| format!("time: {}", done.join("; ")))
    }
}

/// A number that stands beside the signals of a file: a parameter of the bench, perhaps.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Constant {
    /// Its name in the file; with the groups it stands in only where the name alone is doubtful.
    pub name: String,
    /// Its value, in the unit in which the file has it.
    pub value: f64,
}

/// What the reader found in a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The file as the user named it.
    pub file: String,
    /// What places are counted in.
    pub counted: Counted,
    /// Samples of the recording.
    pub samples: usize,
    /// How it is sampled.
    pub sampling: Sampling,
    /// Time of the last sample, s.
    pub end_s: f64,
    /// What became of every column.
    pub columns: Vec<ColumnNote>,
    /// What the reader made of the file beyond its columns' names, a sentence each.
    pub notes: Vec<String>,
    /// Columns or variables that hold no series of numbers, and why.
    pub left_out: Vec<String>,
    /// Numbers that stand beside the signals, as a MAT file may hold `J` and `K_m`.
    pub constants: Vec<Constant>,
    /// Signals of another rate that were interpolated onto the time of the others, a phrase each.
    pub joined: Vec<String>,
    /// Rows at which a new segment begins.
    pub gaps: Stretches,
    /// Rows that repeat the one before, left out.
    pub repeated: Stretches,
    /// Rows without a time, left out.
    pub unstamped: Stretches,
    /// Every signal by itself.
    pub signals: Vec<SignalQuality>,
    /// Signals whose units or signs contradict each other.
    pub suspicions: Vec<Suspicion>,
}

impl Report {
    /// Checks that the recording has all these signals, without holes.
    ///
    /// # Errors
    /// [`Error::MissingSignal`] or [`Error::NotFinite`] with the line of the first hole.
    pub fn require(&self, recording: &Recording, names: &[&str]) -> Result<(), Error> {
        for name in names {
            recording.needed(name)?;
            let Some(quality) = self.signals.iter().find(|it| it.name == *name) else { continue };
            if let Some(first) = quality.missing.listed.first() {
                let (file, counted) = (self.file.clone(), self.counted);
                return Err(Error::NotFinite {
                    place: Place { file, at: first.first, counted },
                    signal: (*name).to_owned(),
                    samples: quality.missing.samples,
                    stretches: quality.missing.count,
                });
            }
        }
        Ok(())
    }

    /// What was assumed about columns, a sentence each.
    pub fn guesses(&self) -> Vec<String> {
        self.notes.iter().cloned().chain(self.columns.iter().filter_map(guess)).collect()
    }

    /// What deserves attention before the recording is used, a sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings: Vec<String> =
            self.left_out.iter().map(|it| format!("left out: {it}")).collect();
        warnings.extend(self.sampling.line(self.gaps.count));
        warnings.extend(self.joined.iter().map(|it| format!("interpolated: {it}")));
        if !self.gaps.is_empty() {
            let places = self.gaps.text(self.counted);
            warnings.push(format!("a new segment begins at {places}"));
        }
        if !self.repeated.is_empty() {
            let places = self.repeated.text(self.counted);
            warnings.push(format!("rows that repeat the one before left out: {places}"));
        }
        if !self.unstamped.is_empty() {
            let places = self.unstamped.text(self.counted);
            warnings.push(format!("rows without a time left out: {places}"));
        }
        for signal in &self.signals {
            if !signal.missing.is_empty() {
                let places = signal.missing.text(self.counted);
                let (name, samples) = (&signal.name, signal.missing.samples);
                warnings.push(format!("{name}: {samples} samples missing or not finite, {places}"));
            }
            warnings.extend(signal.warnings(self.sampling.period_s));
        }
        warnings.extend(self.suspicions.iter().map(Suspicion::to_string));
        warnings
    }
}

fn guess(column: &ColumnNote) -> Option<String> {
    let ColumnNote { column: name, signal, unit, .. } = column;
    let given = column.given_unit.as_deref().map_or(String::new(), |unit| format!(" [{unit}]"));
    let then = match (column.converted, &column.given_unit) {
        (true, _) => format!(", converted to {unit}"),
        (false, None) => format!(", its unit as {unit}"),
        _ => String::new(),
    };
    match column.taken {
        Taken::Guessed => Some(format!("column `{name}`{given} taken as {signal}{then}")),
        Taken::Kept => Some(format!("column `{name}`{given} is not known and kept as it is")),
        Taken::Named if column.given_unit.is_none() => {
            Some(format!("column `{name}` has no unit: taken as {unit}"))
        }
        Taken::Named | Taken::Mapped if column.converted => {
            Some(format!("column `{name}`{given} taken as {signal}{then}"))
        }
        Taken::Named | Taken::Mapped => None,
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Sampling { start_s, period_s, .. } = self.sampling;
        let end_s = self.end_s;
        let samples = self.samples;
        writeln!(
            f,
            "{}: {samples} samples every {} s, {} s to {} s",
            self.file,
            rounded(period_s),
            rounded(start_s),
            rounded(end_s)
        )?;
        for line in self.guesses().iter().chain(&self.warnings()) {
            writeln!(f, "  {line}")?;
        }
        Ok(())
    }
}
