//! Recordings of a session: read, their columns matched, wrong units found and corrected.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use drivescope_discovery::{Error, Measured, doubts};
use drivescope_plant::drive::Drive;
use drivescope_recording::{
    Mapping, Quantity, ReadOptions, Recording, Report, Suspicion, Unit, read,
};
use tempfile::TempPath;

use crate::failure::told;

/// Where a recording lies.
#[derive(Debug)]
enum Source {
    /// A file of this server, removed with the recording.
    Own(TempPath),
    /// A file that the command line named.
    Given(PathBuf),
    /// None: it was simulated.
    Made,
}

/// A recording that was read.
#[derive(Debug)]
pub(super) struct Taken {
    /// What it is called.
    pub(super) name: String,
    /// Its signals.
    pub(super) recording: Arc<Recording>,
    /// What became of its columns; none where it was simulated.
    pub(super) report: Option<Report>,
    /// Columns that the user named.
    pub(super) columns: Vec<Mapping>,
    source: Source,
}

/// A unit that looks wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct UnitFix {
    /// Number of the recording.
    pub(super) recording: usize,
    /// The column.
    pub(super) column: String,
    /// The signal that it holds.
    pub(super) signal: String,
    /// The unit that it is likely in.
    pub(super) unit: &'static str,
    /// Why.
    pub(super) words: String,
}

impl Taken {
    /// The recording of a file that the command line named.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub(super) fn named(path: &Path) -> Result<Self, String> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Self::read(name, Source::Given(path.to_owned()), Vec::new())
    }

    /// The recording of a file of this server, under the name that the user knows.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub(super) fn uploaded(name: String, path: TempPath) -> Result<Self, String> {
        Self::read(name, Source::Own(path), Vec::new())
    }

    /// A recording that was simulated.
    pub(super) fn made(name: String, recording: Recording) -> Self {
        let recording = Arc::new(recording);
        Self { name, recording, report: None, columns: Vec::new(), source: Source::Made }
    }

    fn read(name: String, source: Source, columns: Vec<Mapping>) -> Result<Self, String> {
        let path: &Path = match &source {
            Source::Own(path) => path,
            Source::Given(path) => path,
            Source::Made => return Err(format!("{name}: it has no file")),
        };
        let (recording, report) = read_named(path, &name, &columns)?;
        Ok(Self { name, recording: Arc::new(recording), report: Some(report), columns, source })
    }

    /// Takes the column as that signal in that unit.
    ///
    /// # Errors
    /// Why the recording cannot be read so; it stays as it was.
    pub(super) fn map(&mut self, column: &str, signal: &str, unit: &str) -> Result<(), String> {
        let mut columns = self.columns.clone();
        columns.retain(|it| it.foreign != column && it.canonical != signal);
        columns.push(Mapping {
            canonical: signal.to_owned(),
            foreign: column.to_owned(),
            unit: Some(unit.to_owned()).filter(|unit| !unit.is_empty()),
        });
        let path: &Path = match &self.source {
            Source::Own(path) => path,
            Source::Given(path) => path,
            Source::Made => return Err(format!("{}: its units are right", self.name)),
        };
        let (recording, report) = read_named(path, &self.name, &columns)?;
        (self.recording, self.report) = (Arc::new(recording), Some(report));
        self.columns = columns;
        Ok(())
    }

    /// Units that look wrong, as recording `number` of a session with that drive.
    pub(super) fn fixes(&self, number: usize, drive: &Drive) -> Vec<UnitFix> {
        let suspicions = self.report.iter().flat_map(|report| &report.suspicions);
        let mut fixes: Vec<UnitFix> =
            suspicions.filter_map(|it| self.suspected(number, it)).collect();
        let impossible = Measured::new(drive, &self.recording)
            .and_then(|measured| doubts(drive, &measured).map(drop))
            .err();
        if let Some(Error::ImpossibleSpeed { name, largest, possible, .. }) = impossible {
            let words = format!(
                "{name} reaches {:.0} times what u and K_e of the drive allow",
                largest / possible
            );
            // The speed that a motor is recorded at is near its no-load speed.
            let fix = self
                .fix(number, name, words, |si| (0.15..1.5).contains(&(si * largest / possible)));
            fixes.extend(fix);
        }
        fixes.dedup_by(|a, b| a.column == b.column);
        fixes
    }

    fn suspected(&self, number: usize, suspicion: &Suspicion) -> Option<UnitFix> {
        let words = suspicion.to_string();
        let near = |value: f64| (value - 1.0).abs() < 0.05;
        match suspicion {
            Suspicion::Ratio { signal, with, ratio, .. } => self
                .fix(number, signal, words.clone(), |si| near(si * ratio))
                .or_else(|| self.fix(number, with, words, |si| near(si / ratio))),
            Suspicion::TooFast { signal, .. } => {
                self.fix(number, signal, words, |si| near(si * 30.0 / std::f64::consts::PI))
            }
            Suspicion::TooSlow { .. } => self.fix(number, "time", words, |si| near(si * 1e3)),
        }
    }

    /// The unit, other than that of now, whose value in SI units `is` right for.
    fn fix(
        &self,
        number: usize,
        signal: &str,
        words: String,
        is: impl Fn(f64) -> bool,
    ) -> Option<UnitFix> {
        let notes = &self.report.as_ref()?.columns;
        let note = notes.iter().find(|note| note.signal == signal)?;
        let now = Unit::parse(note.given_unit.as_deref().unwrap_or(&note.unit))?;
        let right = |unit: &&str| {
            Unit::parse(unit).is_some_and(|unit| is(unit.to_si(1.0) / now.to_si(1.0)))
        };
        let unit = now.quantity.units().find(right)?;
        let (column, signal) = (note.column.clone(), note.signal.clone());
        Some(UnitFix { recording: number, column, signal, unit, words })
    }

    /// What `--columns` would say.
    pub(super) fn columns_option(&self) -> String {
        let one = |it: &Mapping| {
            let unit = it.unit.as_ref().map_or(String::new(), |unit| format!(":{unit}"));
            format!("{}={}{unit}", it.canonical, it.foreign)
        };
        self.columns.iter().map(one).collect::<Vec<_>>().join(",")
    }
}

/// Units that a column may be in, given the one of now.
pub(super) fn units_like(unit: &str) -> Vec<&'static str> {
    Unit::parse(unit)
        .filter(|it| it.quantity != Quantity::Dimensionless)
        .map(|it| it.quantity.units().collect())
        .unwrap_or_default()
}

/// Reads the file; what is said of it names what the user called it.
fn read_named(path: &Path, name: &str, columns: &[Mapping]) -> Result<(Recording, Report), String> {
    let options = ReadOptions { columns: columns.to_vec(), resample: None };
    let read = read(path, &options);
    let own = path.display().to_string();
    let (mut recording, mut report) =
        read.map_err(|error| told(error).to_string().replace(&own, name))?;
    name.clone_into(&mut recording.name);
    name.clone_into(&mut report.file);
    Ok((recording, report))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    /// The speed of the built-in motor in rpm under a header that says rad/s.
    fn mistaken() -> Taken {
        let mut file = tempfile::Builder::new().suffix(".csv").tempfile().expect("a file");
        writeln!(file, "time [s],u [V],omega [rad/s]").expect("written");
        for k in 0..2000 {
            let t = f64::from(k) * 1e-3;
            let u = 10.0 * (6.0 * t).sin();
            writeln!(file, "{t},{u},{}", 1500.0 * (6.0 * t - 0.3).sin()).expect("written");
        }
        Taken::uploaded("bench.csv".to_owned(), file.into_temp_path()).expect("it can be read")
    }

    #[test]
    fn rpm_under_a_wrong_header_is_found_and_corrected() {
        let drive = crate::drive_source::drive("dr300").expect("it is built in");
        let mut taken = mistaken();
        let fixes = taken.fixes(0, &drive);
        assert_eq!(fixes.len(), 1, "{fixes:?}");
        assert_eq!((fixes[0].column.as_str(), fixes[0].unit), ("omega", "rpm"));
        taken.map("omega", "omega", fixes[0].unit).expect("it can be read so");
        assert_eq!(taken.fixes(0, &drive), []);
        assert_eq!(taken.columns_option(), "omega=omega:rpm");
        let speed = taken.recording.signal("omega").expect("it is there");
        assert!(speed.values.iter().all(|it| it.abs() < 158.0));
    }

    #[test]
    fn a_unit_of_another_quantity_changes_nothing() {
        let mut taken = mistaken();
        let said = taken.map("omega", "omega", "V").expect_err("no speed");
        assert!(said.contains("bench.csv") && !said.contains("tmp"), "{said}");
        assert_eq!(taken.columns, []);
    }
}
