//! A file's columns as they stand, before they are mapped: for whoever says what they are.

use drivescope_units::{Quantity, Unit};
use serde::Serialize;

use crate::canonical;
use crate::given::Given;
use crate::guess;
use crate::table::Table;
use crate::time_unit::{by_step, median_step};

/// Buckets that a column is thinned to: enough for a plot as wide as a word.
const BUCKETS: usize = 120;
/// Share of the steps that may stand still or run back in a column that may be the time.
const NOT_RISING: f64 = 0.02;

/// The columns of a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Preview {
    /// Rows of numbers.
    pub rows: usize,
    /// Sampling time, s, where the file gives one without a time column.
    pub period_s: Option<f64>,
    /// The columns in the order of the file.
    pub columns: Vec<ColumnPreview>,
}

/// A column as it stands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnPreview {
    /// What a mapping calls it: its name, or `u#2` for the second column called `u`.
    pub key: String,
    /// The whole text of its header.
    pub text: String,
    /// Its name in the header.
    pub name: String,
    /// The unit in the header.
    pub unit: Option<String>,
    /// The signal that its name and unit tell, if they do.
    pub guess: Option<&'static str>,
    /// The unit in which it may be the time: it rises from row to row.
    pub as_time: Option<String>,
    /// Least value in the unit of the file; NaN where there is none.
    pub least: f64,
    /// Greatest value in the unit of the file; NaN where there is none.
    pub greatest: f64,
    /// Least and greatest value of some hundred stretches of equal length; NaN where a stretch
    /// has none.
    pub thinned: Vec<(f64, f64)>,
}

impl Preview {
    /// The columns of a table.
    pub(crate) fn of(table: &Table) -> Preview {
        let mut columns: Vec<ColumnPreview> = Vec::new();
        for (text, values) in table.header.iter().zip(&table.columns) {
            let Given { text, name, unit } = Given::of(text);
            let before = columns.iter().filter(|it| it.name == name).count();
            let key = if before == 0 { name.clone() } else { format!("{name}#{}", before + 1) };
            let guess = canonical::exact(&name)
                .or_else(|| guess::guess(&name, unit.as_deref(), None).map(|it| it.canonical));
            let as_time = as_time(unit.as_deref(), values);
            let thinned = thinned(values);
            let (least, greatest) = range(thinned.iter().flat_map(|it| [it.0, it.1]));
            let guess = guess.map(|it| it.name);
            columns.push(ColumnPreview {
                key,
                text,
                name,
                unit,
                guess,
                as_time,
                least,
                greatest,
                thinned,
            });
        }
        let rows = table.columns.first().map_or(0, Vec::len);
        Preview { rows, period_s: table.period_s, columns }
    }

    /// The column that a mapping calls so: by its key, or by the whole text of its header.
    pub fn find(&self, called: &str) -> Option<&ColumnPreview> {
        let by_key = self.columns.iter().find(|it| it.key == called);
        by_key.or_else(|| self.columns.iter().find(|it| it.text == called))
    }
}

/// The unit in which the values may be a time: that of the header, or the one that its steps tell.
fn as_time(unit: Option<&str>, values: &[f64]) -> Option<String> {
    if unit.and_then(Unit::parse).is_some_and(|unit| unit.quantity != Quantity::Time) {
        return None;
    }
    let still = values.windows(2).filter(|pair| pair[1] <= pair[0]).count();
    if values.len() < 2 || still as f64 > NOT_RISING * values.len() as f64 {
        return None;
    }
    let step = median_step(values)?;
    let known = unit.filter(|it| Unit::parse(it).is_some());
    Some(known.or(by_step(step)).unwrap_or("s").to_owned())
}

fn thinned(values: &[f64]) -> Vec<(f64, f64)> {
    let length = values.len().div_ceil(BUCKETS).max(1);
    values.chunks(length).map(|bucket| range(bucket.iter().copied())).collect()
}

/// Least and greatest of what is finite.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|it| it.is_finite());
    finite.fold((f64::NAN, f64::NAN), |(least, greatest), it| (least.min(it), greatest.max(it)))
}

#[cfg(test)]
mod tests {
    use crate::error::Error;
    use crate::file::read_with_preview;
    use crate::mapping::{Mapping, ReadOptions};

    use super::*;

    fn file(text: &str) -> tempfile::NamedTempFile {
        let file = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
        std::fs::write(file.path(), text).unwrap();
        file
    }

    fn rows(header: &str, row: impl Fn(f64) -> String) -> String {
        let rows = (0..1000).map(|k| row(f64::from(k)));
        std::iter::once(header.to_owned()).chain(rows).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn columns_are_seen_even_where_they_make_no_recording() {
        let log = file(&rows("stamp,u,u,omega [furlong]", |k| {
            format!("{},{},{},{}", 2.0 * k, (0.1 * k).sin(), k % 2.0, 7.5 - k)
        }));
        let (preview, read) = read_with_preview(log.path(), &ReadOptions::default()).unwrap();
        assert!(matches!(read, Err(Error::DuplicateColumn { .. })), "{read:?}");
        assert_eq!((preview.rows, preview.columns.len()), (1000, 4));
        let keys: Vec<&str> = preview.columns.iter().map(|it| it.key.as_str()).collect();
        assert_eq!(keys, ["stamp", "u", "u#2", "omega"]);
        let times: Vec<_> = preview.columns.iter().map(|it| it.as_time.as_deref()).collect();
        assert_eq!(times, [Some("ms"), None, None, None]);
        let speed = &preview.columns[3];
        assert_eq!((speed.least, speed.greatest), (7.5 - 999.0, 7.5));
        assert_eq!((speed.guess, speed.unit.as_deref()), (Some("omega"), Some("furlong")));
        assert!(speed.thinned.len() <= BUCKETS && speed.thinned[0].1 == 7.5);

        // What is said of the columns makes it one.
        let said = ["time=stamp:ms", "omega=omega:rpm"].join(",");
        let mut columns = Mapping::parse_list(&said).unwrap();
        columns.push(Mapping::unused("u#2"));
        let options = ReadOptions { columns, ..ReadOptions::default() };
        let (recording, _) = read_with_preview(log.path(), &options).unwrap().1.unwrap();
        assert_eq!(recording.period_s, 0.002);
        assert_eq!(recording.signal("u").unwrap().values[5], (0.5_f64).sin());
        assert!(recording.signal("u_2_unused").is_some());
    }

    #[test]
    fn rows_without_a_time_lie_as_far_apart_as_was_said() {
        let log = file(&rows("u [V],omega [rad/s]", |k| format!("{},{k}", (0.1 * k).sin())));
        let (preview, read) = read_with_preview(log.path(), &ReadOptions::default()).unwrap();
        assert!(matches!(read, Err(Error::MissingTime { .. })), "{read:?}");
        assert_eq!(preview.period_s, None);
        let every = |rows_every| ReadOptions { rows_every, ..ReadOptions::default() };
        let (recording, _) = crate::read(log.path(), &every(Some(0.004))).unwrap();
        assert_eq!((recording.period_s, recording.len()), (0.004, 1000));
        let wrong = crate::read(log.path(), &every(Some(-1.0))).unwrap_err();
        assert!(matches!(wrong, Error::Period { .. }), "{wrong}");
        // A time that goes back and forth is set aside.
        let log = file(&rows("time,u", |k| format!("{},{}", (7.0 * k).sin(), (0.1 * k).sin())));
        let (recording, report) = crate::read(log.path(), &every(Some(0.004))).unwrap();
        assert_eq!((recording.period_s, recording.signals.len()), (0.004, 1));
        assert!(report.guesses()[0].contains("`time` is not used"), "{:?}", report.guesses());
    }
}
