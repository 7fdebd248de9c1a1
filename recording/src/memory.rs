//! Columns that lie in memory, taken as those of a file are: names, units and time are read from
//! them in the same way, so that a data frame gives what its file would.

use crate::error::Error;
use crate::file::Outcome;
use crate::mapping::ReadOptions;
use crate::place::Lines;
use crate::signal::Recording;
use crate::table::Table;

/// A recording of columns, each with the text that would stand above it (`omega [rad/s]`); one of
/// them is the time, unless options say how far rows lie apart. `name` is what messages call it.
///
/// # Errors
/// As [`crate::read()`], with rows counted from 1; [`Error::UnequalLengths`].
pub fn of_columns(
    name: &str,
    columns: impl IntoIterator<Item = (String, Vec<f64>)>,
    options: &ReadOptions,
) -> Outcome {
    let (header, columns): (Vec<String>, Vec<Vec<f64>>) = columns.into_iter().unzip();
    let expected = columns.first().map_or(0, Vec::len);
    let other = header.iter().zip(&columns).find(|(_, values)| values.len() != expected);
    if let Some((signal, values)) = other {
        let (name, signal, found) = (name.to_owned(), signal.clone(), values.len());
        return Err(Error::UnequalLengths { name, signal, found, expected });
    }
    if columns.is_empty() {
        return Err(Error::NoSignals { file: name.to_owned() });
    }
    Table { header, columns, ..Table::new(Lines::rows(name)) }.into_recording(options)
}

impl Recording {
    /// What [`crate::read()`] would give, were the recording written to a file of that name and
    /// read again.
    ///
    /// # Errors
    /// As [`of_columns`].
    pub fn reread(self, name: &str) -> Outcome {
        let clock = self.clock();
        let time = (0..self.len()).map(|k| clock.time(k)).collect();
        let segment = self.segment_column();
        let time = std::iter::once(("time [s]".to_owned(), time));
        let signals = self.signals.into_iter().chain(segment);
        let columns = time.chain(signals.map(|it| (it.header(), it.values)));
        of_columns(name, columns, &ReadOptions::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Break;
    use crate::signal::Signal;

    fn two_runs() -> Recording {
        let signal = |name: &str, unit: &str, rate: f64| Signal {
            name: name.to_owned(),
            unit: unit.to_owned(),
            values: (0..400).map(|k| (f64::from(k) * rate).sin()).collect(),
        };
        let signals = vec![signal("u", "V", 0.02), signal("omega", "rad/s", 0.015)];
        let breaks = vec![Break { at: 250, start_s: 9.0 }];
        Recording { breaks, ..Recording::new("model", 1.0, 0.005, signals) }
    }

    #[test]
    fn what_lies_in_memory_is_what_a_file_gives() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("run.csv");
        crate::write(&file, &two_runs()).unwrap();
        let name = file.display().to_string();
        let (read, of_file) = crate::read(&file, &ReadOptions::default()).unwrap();
        let (taken, of_memory) = two_runs().reread(&name).unwrap();
        assert_eq!(taken, read);
        assert_eq!(of_memory.signals, of_file.signals);
        assert_eq!(of_memory.sampling, of_file.sampling);
        assert_eq!(taken.segments(), [0..250, 250..400]);
    }

    #[test]
    fn units_are_converted_and_what_is_wrong_is_named() {
        let time: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01).collect();
        let speed = vec![60.0; 100];
        let columns = [("time [s]".to_owned(), time), ("Speed [rpm]".to_owned(), speed)];
        let (taken, report) =
            of_columns("frame", columns.clone(), &ReadOptions::default()).unwrap();
        let omega = taken.signal("omega").unwrap();
        assert!((omega.values[0] - std::f64::consts::TAU).abs() < 1e-12, "{}", omega.values[0]);
        assert!(report.guesses()[0].contains("`Speed` [rpm] taken as omega"), "{report}");
        let [(time, mut short), _] = columns;
        short.pop();
        let unequal = [("u [V]".to_owned(), vec![0.0; 100]), (time, short)];
        let error = of_columns("frame", unequal, &ReadOptions::default()).unwrap_err();
        assert!(error.to_string().contains("frame"), "{error}");
        assert!(of_columns("frame", [], &ReadOptions::default()).is_err());
    }
}
