//! What the user says about columns: `u=Voltage,omega=Speed:rpm`.

use std::str::FromStr;

use crate::canonical;
use crate::error::Error;

/// One column that the user names: `canonical=foreign[:unit]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mapping {
    /// Name that the signal gets (`omega`).
    pub canonical: String,
    /// Name of the column in the file (`Speed`).
    pub foreign: String,
    /// Unit of the column, in place of the one in its header.
    pub unit: Option<String>,
}

impl Mapping {
    /// The column as a signal that no part of the program looks at.
    pub fn unused(column: &str) -> Mapping {
        let plain = canonical::exact(column).is_none() && !column.contains(['=', ',', ':', '#']);
        let canonical = if plain { column.to_owned() } else { unused_name(column) };
        Mapping { canonical, foreign: column.to_owned(), unit: None }
    }

    /// Reads a comma-separated list of mappings, as the command line gives it.
    ///
    /// # Errors
    /// [`Error::Mapping`] with the item that is not `canonical=foreign[:unit]`.
    pub fn parse_list(text: &str) -> Result<Vec<Mapping>, Error> {
        text.split(',').map(str::trim).filter(|item| !item.is_empty()).map(str::parse).collect()
    }
}

/// A name that is no signal's, of letters that a mapping can hold.
fn unused_name(column: &str) -> String {
    let plain = column.replace(|c: char| !c.is_alphanumeric(), "_");
    format!("{plain}_unused")
}

impl FromStr for Mapping {
    type Err = Error;

    fn from_str(text: &str) -> Result<Mapping, Error> {
        let bad = || Error::Mapping { text: text.to_owned() };
        let (canonical, column) = text.split_once('=').ok_or_else(bad)?;
        let (foreign, unit) = match column.rsplit_once(':') {
            Some((foreign, unit)) => (foreign, Some(unit.trim().to_owned())),
            None => (column, None),
        };
        let (canonical, foreign) = (canonical.trim(), foreign.trim());
        if canonical.is_empty() || foreign.is_empty() || unit.as_deref() == Some("") {
            return Err(bad());
        }
        Ok(Mapping { canonical: canonical.to_owned(), foreign: foreign.to_owned(), unit })
    }
}

/// How a recording is to be read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Columns that the user names; they win over every guess.
    pub columns: Vec<Mapping>,
    /// Sampling time to interpolate linearly to, s, in place of the one that the rows show.
    pub resample: Option<f64>,
    /// Sampling time of the rows, s, where no column tells the time or where none is to be believed.
    pub rows_every: Option<f64>,
    /// Whether the signals are those of any model, and not of a drive: a column whose name is that of a
    /// signal of drives keeps its name and its unit where that signal has another, or it says none, and a
    /// time without a unit is in seconds, as simulation tools write it.
    pub of_model: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_with_and_without_units() {
        let read = Mapping::parse_list("u=Voltage, omega = Motor speed:rpm").unwrap();
        assert_eq!(read.len(), 2);
        assert_eq!((read[0].canonical.as_str(), read[0].foreign.as_str()), ("u", "Voltage"));
        assert_eq!(read[0].unit, None);
        assert_eq!(read[1].foreign, "Motor speed");
        assert_eq!(read[1].unit.as_deref(), Some("rpm"));
        assert_eq!(Mapping::parse_list("").unwrap(), []);
    }

    #[test]
    fn what_is_no_mapping_is_named() {
        for text in ["u", "=Voltage", "u=", "u=Voltage:"] {
            let error = Mapping::parse_list(text).unwrap_err().to_string();
            assert!(error.contains(&format!("`{text}`")), "{error}");
        }
    }
}
