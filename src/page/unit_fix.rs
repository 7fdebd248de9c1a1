//! Units that look wrong: found, and corrected by a click.

use drivescope_discovery::{Error, Measured, doubts};
use drivescope_plant::drive::Drive;
use drivescope_recording::{Suspicion, Unit};

use super::plain::plain;
use super::recordings::Taken;

/// A unit that looks wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct UnitFix {
    /// Number of the recording.
    pub(super) recording: usize,
    pub(super) column: String,
    /// The signal that it holds.
    pub(super) signal: String,
    /// The unit that it is likely in.
    pub(super) unit: &'static str,
    /// Why.
    pub(super) words: String,
}

impl Taken {
    /// Units that look wrong, as recording `number` of a session with that drive.
    pub(super) fn fixes(&self, number: usize, drive: &Drive) -> Vec<UnitFix> {
        let suspicions = self.report.iter().flat_map(|report| &report.suspicions);
        let mut fixes: Vec<UnitFix> =
            suspicions.filter_map(|it| self.suspected(number, it)).collect();
        let Some(recording) = &self.recording else { return fixes };
        let impossible = Measured::new(drive, recording)
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
        let words = plain(&suspicion.to_string());
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
        assert_eq!(taken.said(), ["--columns", "omega=omega:rpm"]);
        let speed =
            taken.recording.as_ref().and_then(|it| it.signal("omega")).expect("it is there");
        assert!(speed.values.iter().all(|it| it.abs() < 158.0));
    }
}
