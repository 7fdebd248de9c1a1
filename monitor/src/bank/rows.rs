//! What a bank takes from the signals of a recording.

use drivescope_diagnoser::bank::{Row, SENSORS};
use drivescope_recording::{Recording, Unit};
use thiserror::Error;

/// Signals of a bank.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RowsError {
    /// Nothing drives the process.
    #[error("there is neither a control signal C_m nor a voltage u: the bank needs one")]
    NothingDrives,
    /// Nothing shows what it does.
    #[error("there is neither a speed (T, omega, v) nor a current (I_m, i): the bank needs one")]
    NothingShows,
    /// A signal of another quantity.
    #[error("`{name}` is in {unit}: the bank takes {takes}")]
    Unit {
        /// The signal.
        name: String,
        unit: String,
        /// What it is taken in.
        takes: &'static str,
    },
}

/// Names under which each sensor is looked for, the first that is there, and the SI units of it:
/// first what the controller sees, for a simulated recording holds ideal values beside it.
const SPEED: (&[&str], &[&str]) = (&["T", "omega", "v"], &["rad/s", "m/s"]);
const CURRENT: (&[&str], &[&str]) = (&CURRENTS, &["A"]);
const VOLTAGE: (&[&str], &[&str]) = (&[DRIVING[1]], &["V", "A", "N m", "N"]);
const CONTROL: &str = DRIVING[0];
/// Names of what drives the process, the first that is there.
pub const DRIVING: [&str; 2] = ["C_m", "u"];
/// Names of the current, the first that is there.
pub const CURRENTS: [&str; 2] = ["I_m", "i"];

/// Where a bank finds its signals among columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    control: Option<usize>,
    shown: [Option<(usize, Unit)>; SENSORS],
}

impl Columns {
    /// The columns of a bank among those of these names and units.
    ///
    /// # Errors
    /// Nothing drives, nothing shows, or a unit of another quantity.
    pub fn find(columns: &[(&str, &str)]) -> Result<Self, RowsError> {
        let place = |name: &str| columns.iter().position(|column| column.0 == name);
        let control = place(CONTROL);
        let sensor = |(names, takes): (&[&str], &'static [&'static str])| {
            let Some(at) = names.iter().find_map(|name| place(name)) else { return Ok(None) };
            let (name, unit) = columns[at];
            let known = Unit::parse(unit).filter(|it| takes.contains(&it.quantity.si()));
            known.map(|known| Some((at, known))).ok_or_else(|| RowsError::Unit {
                name: name.to_owned(),
                unit: unit.to_owned(),
                takes: takes[0],
            })
        };
        let mut shown = [sensor(SPEED)?, sensor(CURRENT)?, None];
        // Behind the voltage an amplifier that fails is not seen: the control effort comes first.
        if control.is_none() {
            shown[2] = sensor(VOLTAGE)?;
        }
        if control.is_none() && shown[2].is_none() {
            return Err(RowsError::NothingDrives);
        }
        if shown[0].is_none() && shown[1].is_none() {
            return Err(RowsError::NothingShows);
        }
        Ok(Self { control, shown })
    }

    /// Whether the current is among them.
    pub fn has_current(&self) -> bool {
        self.shown[1].is_some()
    }

    /// The row of these values, one a column.
    pub fn row(&self, value: impl Fn(usize) -> f64) -> Row {
        let shown =
            |m: usize| self.shown[m].as_ref().map_or(f64::NAN, |(at, unit)| unit.to_si(value(*at)));
        Row { control: self.control.map_or(f64::NAN, &value), shown: std::array::from_fn(shown) }
    }

    /// The columns of a recording, and its rows.
    ///
    /// # Errors
    /// As [`Self::find`].
    pub fn of(recording: &Recording) -> Result<(Self, Vec<Row>), RowsError> {
        let signals = recording.signals.iter();
        let named: Vec<(&str, &str)> = signals.map(|s| (&*s.name, &*s.unit)).collect();
        let columns = Self::find(&named)?;
        let row = |k: usize| columns.row(|at| recording.signals[at].values[k]);
        let rows = (0..recording.len()).map(row).collect();
        Ok((columns, rows))
    }
}

/// The rows as they would be without a current sensor.
pub fn without_current(rows: &[Row]) -> Vec<Row> {
    let blind = |row: &Row| Row { shown: [row.shown[0], f64::NAN, row.shown[2]], ..*row };
    rows.iter().map(blind).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_are_taken_in_si_whatever_their_names() {
        let columns = [("u", "V"), ("C_m", "V"), ("T", "rpm"), ("I_m", "A"), ("omega", "rad/s")];
        let found = Columns::find(&columns).expect("they are all there");
        let row = found.row(|at| [0.0, 7.0, 30.0, 0.5, 9.0][at]);
        assert_eq!((row.control, row.shown[1]), (7.0, 0.5));
        assert!((row.shown[0] - std::f64::consts::PI).abs() < 1e-12 && row.shown[2].is_nan());
        assert!(found.has_current());
        let silent = Columns::find(&[("C_m", "V"), ("temperature", "K")]);
        assert_eq!(silent, Err(RowsError::NothingShows));
        assert_eq!(Columns::find(&[("T", "rpm")]), Err(RowsError::NothingDrives));
        let wrong = Columns::find(&[("C_m", "V"), ("omega", "V")]).expect_err("a voltage");
        assert!(wrong.to_string().contains("`omega` is in V"), "{wrong}");
    }
}
