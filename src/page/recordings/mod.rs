//! Recordings of a session: read, their columns matched, and what was said of them kept.

mod columns;
mod content;
mod source;

use std::path::Path;
use std::sync::Arc;

use drivescope_recording::{Mapping, Preview, ReadOptions, Recording, Report};
use tempfile::TempPath;

use content::{Content, read_named};
use source::{Source, keep, shown_place};

use crate::failure::into_report;
use crate::page::incomplete::Incomplete;

/// A recording that was read, or that is to be completed.
#[derive(Debug)]
pub(in crate::page) struct Taken {
    /// What it is called.
    pub(in crate::page) name: String,
    /// Its signals; none where it is to be completed.
    pub(in crate::page) recording: Option<Arc<Recording>>,
    /// What became of its columns; none where it was simulated or is to be completed.
    pub(in crate::page) report: Option<Report>,
    /// Its columns as they stand in the file; none where it was simulated.
    pub(in crate::page) preview: Option<Preview>,
    /// What it lacks.
    pub(in crate::page) incomplete: Option<Incomplete>,
    /// What was said of its columns and its time.
    pub(in crate::page) options: ReadOptions,
    /// Where that is kept, or why it is not, in words.
    pub(in crate::page) kept: Option<String>,
    source: Source,
}

impl Taken {
    /// The recording of a file that the command line named, as what was kept beside it says.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub(in crate::page) fn named(path: &Path) -> Result<Self, String> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let kept = ReadOptions::kept(path).map_err(|error| into_report(error).to_string())?;
        let said = kept.is_some().then(|| format!("As kept in {}.", shown_place(path)));
        let taken = Self::read(name, Source::Given(path.to_owned()), kept.unwrap_or_default())?;
        Ok(Self { kept: said, ..taken })
    }

    /// The recording of a file of this server, under the name that the user knows.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub(in crate::page) fn uploaded(name: String, path: TempPath) -> Result<Self, String> {
        Self::read(name, Source::Own(path), ReadOptions::default())
    }

    /// A recording that was simulated.
    pub(in crate::page) fn made(name: String, recording: Recording) -> Self {
        let content = Content { recording: Some(recording), ..Content::default() };
        Self::of(name, Source::Made, ReadOptions::default(), content)
    }

    /// Whether it was simulated.
    pub(in crate::page) fn is_made(&self) -> bool {
        matches!(self.source, Source::Made)
    }

    fn read(name: String, source: Source, options: ReadOptions) -> Result<Self, String> {
        let path = source.path().ok_or_else(|| format!("{name}: it has no file"))?;
        let content = read_named(path, &name, &options)?;
        Ok(Self::of(name, source, options, content))
    }

    fn of(name: String, source: Source, options: ReadOptions, content: Content) -> Self {
        let Content { recording, report, preview, incomplete } = content;
        let recording = recording.map(Arc::new);
        Self { name, recording, report, preview, incomplete, options, kept: None, source }
    }

    /// Samples it every `period_s`, s, or as it was sampled.
    ///
    /// # Errors
    /// Why it cannot be; it stays as it was.
    pub(in crate::page) fn resample(&mut self, period_s: Option<f64>) -> Result<(), String> {
        self.re_read(ReadOptions { resample: period_s, ..self.options.clone() }, None)
    }

    /// Takes its rows as sampled every `period_s`, s, or by their time.
    ///
    /// # Errors
    /// Why it cannot be; it stays as it was.
    pub(in crate::page) fn rows_every(&mut self, period_s: Option<f64>) -> Result<(), String> {
        self.re_read(ReadOptions { rows_every: period_s, ..self.options.clone() }, None)
    }

    /// Forgets what was said of it.
    ///
    /// # Errors
    /// Why it cannot be read so; it stays as it was.
    pub(in crate::page) fn again(&mut self) -> Result<(), String> {
        self.re_read(ReadOptions::default(), None)
    }

    /// Reads it anew. What was said of `column` must not be what is wrong then.
    fn re_read(&mut self, options: ReadOptions, column: Option<&str>) -> Result<(), String> {
        let own = || format!("{}: it was simulated, nothing is to be said of it", self.name);
        let path = self.source.path().ok_or_else(own)?;
        let content = read_named(path, &self.name, &options)?;
        if let Some(incomplete) = &content.incomplete {
            let blamed = column.is_some() && incomplete.unit_of.as_deref() == column;
            if self.incomplete.is_none() || blamed {
                return Err(format!("{}: {}", self.name, incomplete.missing));
            }
        }
        let kept = match &self.source {
            Source::Given(path) if content.incomplete.is_none() => Some(keep(&options, path)),
            _ => self.kept.clone(),
        };
        let (name, source) =
            (std::mem::take(&mut self.name), std::mem::replace(&mut self.source, Source::Made));
        *self = Self { kept, ..Self::of(name, source, options, content) };
        Ok(())
    }

    /// What a command line calls it: a file that was given there is where it was.
    pub(in crate::page) fn on_a_command_line(&self) -> String {
        match &self.source {
            Source::Given(path) => path.display().to_string(),
            Source::Own(_) | Source::Made => self.name.clone(),
        }
    }

    /// What a command line would say of its columns and its time, word by word.
    pub(in crate::page) fn said(&self) -> Vec<String> {
        let ReadOptions { columns, resample, rows_every, .. } = &self.options;
        let one = |it: &Mapping| {
            let unit = it.unit.as_ref().map_or(String::new(), |unit| format!(":{unit}"));
            format!("{}={}{unit}", it.canonical, it.foreign)
        };
        let columns = columns.iter().map(one).collect::<Vec<_>>().join(",");
        let columns = Some(columns).filter(|it| !it.is_empty());
        let number = |it: &Option<f64>| it.map(|it| it.to_string());
        let options = [
            ("--columns", columns),
            ("--resample", number(resample)),
            ("--rows-every", number(rows_every)),
        ];
        let said = options.into_iter().filter_map(|(name, value)| Some([name.to_owned(), value?]));
        said.flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::incomplete::Repair;

    pub(super) fn rows(header: &str, row: impl Fn(f64) -> String) -> String {
        let rows = (0..1000).map(|k| row(f64::from(k)));
        std::iter::once(header.to_owned()).chain(rows).collect::<Vec<_>>().join("\n")
    }

    pub(super) fn taken(text: &str) -> Taken {
        let file = tempfile::Builder::new().suffix(".csv").tempfile().expect("a file");
        std::fs::write(file.path(), text).expect("written");
        Taken::uploaded("bench.csv".to_owned(), file.into_temp_path()).expect("it has numbers")
    }

    pub(super) fn range(taken: &Taken, signal: &str) -> (f64, f64) {
        let values =
            &taken.recording.as_ref().and_then(|it| it.signal(signal)).expect(signal).values;
        values.iter().fold((f64::MAX, f64::MIN), |(low, high), it| (low.min(*it), high.max(*it)))
    }

    /// Takes the first way out.
    fn repair(taken: &mut Taken) {
        let repairs = taken.incomplete.as_ref().map(|it| it.repairs.clone()).expect("incomplete");
        match repairs.first().expect("a way out") {
            Repair::Column { column, signal, unit, .. } => taken.map(column, signal, unit),
            Repair::Again => taken.again(),
        }
        .expect("it can be read so");
    }

    #[test]
    fn every_first_way_out_completes_a_recording() {
        for header in ["time,u [V],u [V]", "time,u [V],u [mV]", "time,u [V],omega [furlong]"] {
            let mut taken = taken(&rows(header, |k| format!("{k},{},{}", k % 7.0, 5.0 - k % 3.0)));
            assert!(taken.recording.is_none(), "{header}");
            repair(&mut taken);
            assert!(taken.recording.is_some(), "{header}: {:?}", taken.incomplete);
        }
    }

    #[test]
    fn rows_without_a_time_are_sampled_as_was_said() {
        let mut taken = taken(&rows("u [V],omega [rad/s]", |k| format!("{},{}", k % 7.0, k % 5.0)));
        assert!(
            taken.incomplete.as_ref().is_some_and(|it| it.asks_period && it.repairs.is_empty())
        );
        taken.rows_every(Some(0.002)).expect("a time");
        assert_eq!(taken.recording.as_ref().map(|it| it.period_s), Some(0.002));
        taken.resample(Some(0.004)).expect("a time");
        assert_eq!(taken.recording.as_ref().map(|it| it.period_s), Some(0.004));
        assert_eq!(taken.said(), ["--resample", "0.004", "--rows-every", "0.002"]);
        assert!(taken.resample(Some(-1.0)).is_err());
        assert_eq!(taken.recording.as_ref().map(|it| it.period_s), Some(0.004));
    }

    #[test]
    fn what_was_said_of_a_named_file_is_kept_beside_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let log = folder.path().join("log.csv");
        let text = rows("clock,Volt,Turns", |k| format!("{k},{},{}", k % 7.0, k % 5.0));
        std::fs::write(&log, text).expect("written");
        let mut taken = Taken::named(&log).expect("it has numbers");
        taken.map("clock", "time", "ms").expect("a time");
        taken.map("Turns", "omega", "rpm").expect("a speed");
        assert!(taken.kept.as_ref().is_some_and(|it| it.contains("log.csv.columns.toml")));
        let again = Taken::named(&log).expect("it was kept");
        assert_eq!(again.options.columns.len(), 2);
        assert_eq!(range(&again, "omega"), range(&taken, "omega"));
        // A file of that name with other columns: what was kept is said to be wrong, and forgotten.
        std::fs::write(&log, rows("time,u", |k| format!("{},1", k * 1e-3))).expect("written");
        let mut other = Taken::named(&log).expect("it has numbers");
        repair(&mut other);
        assert!(other.recording.is_some());
    }
}
