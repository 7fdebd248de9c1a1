//! From column headers to signals: names, units, guesses.

use serde::Serialize;

use crate::canonical::{self, Canonical};
use crate::error::Error;
use crate::mapping::Mapping;
use crate::unit::{Unit, known};

/// How a column came to its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Taken {
    /// The header names the signal.
    Named,
    /// The user said so.
    Mapped,
    /// A foreign name was recognised.
    Guessed,
    /// An unknown column, kept as it is.
    Kept,
}

/// What became of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnNote {
    /// The column's name in the file.
    pub column: String,
    /// The unit in its header or in the mapping.
    pub given_unit: Option<String>,
    /// The signal's name.
    pub signal: String,
    /// The unit of the signal's values.
    pub unit: String,
    /// Why.
    pub taken: Taken,
    /// Whether values were converted to another unit.
    pub converted: bool,
}

/// A column with its name, its unit and the way its values get there.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub(crate) note: ColumnNote,
    conversion: Option<Unit>,
}

impl Column {
    pub(crate) fn convert(&self, value: f64) -> f64 {
        self.conversion.map_or(value, |unit| unit.to_si(value))
    }

    pub(crate) fn convert_all(&self, values: &mut [f64]) {
        if let Some(unit) = self.conversion {
            values.iter_mut().for_each(|value| *value = unit.to_si(*value));
        }
    }
}

/// The columns of a table, and which of them is the time.
#[derive(Debug)]
pub(crate) struct Header {
    pub(crate) columns: Vec<Column>,
    /// Position of the time column; none only where a file gives a sampling time instead.
    pub(crate) time: Option<usize>,
}

/// A header's text split into name and unit.
struct Given {
    text: String,
    name: String,
    unit: Option<String>,
}

/// Gives every column its name and unit.
pub(crate) fn resolve(file: &str, texts: &[String], maps: &[Mapping]) -> Result<Header, Error> {
    let given: Vec<Given> = texts.iter().map(|text| split(text)).collect();
    for (second, column) in given.iter().enumerate() {
        if let Some(first) = given[..second].iter().position(|other| other.name == column.name) {
            let name = column.name.clone();
            let (first, second) = (first + 1, second + 1);
            return Err(Error::DuplicateColumn { file: file.to_owned(), name, first, second });
        }
    }
    let mut columns: Vec<Option<Column>> = vec![None; given.len()];
    for map in maps {
        let position = find(&given, &map.foreign).ok_or_else(|| Error::MappedColumn {
            file: file.to_owned(),
            column: map.foreign.clone(),
            signal: map.canonical.clone(),
            columns: listed(&given),
        })?;
        let unit = map.unit.as_ref().or(given[position].unit.as_ref());
        let known = canonical::exact(&map.canonical);
        let column = place(file, &given[position], &map.canonical, known, unit, Taken::Mapped)?;
        columns[position] = Some(column);
    }
    let mut used: Vec<&str> = maps.iter().map(|map| map.canonical.as_str()).collect();
    // Exact names first, so that no guess takes a name that a later column carries itself.
    for (slot, column) in columns.iter_mut().zip(&given).filter(|(slot, _)| slot.is_none()) {
        let unit = column.unit.as_deref();
        let Some(known) = canonical::exact(&column.name) else { continue };
        let fits = unit.is_none_or(|unit| known.accepts(unit));
        if fits || canonical::guess(&column.name, unit).is_none() {
            let unit = column.unit.as_ref();
            *slot = Some(place(file, column, known.name, Some(known), unit, Taken::Named)?);
            used.push(known.name);
        }
    }
    for (slot, column) in columns.iter_mut().zip(&given).filter(|(slot, _)| slot.is_none()) {
        let unit = column.unit.as_deref();
        let guess = canonical::guess(&column.name, unit).filter(|it| !used.contains(&it.name));
        *slot = Some(match guess {
            Some(known) => {
                used.push(known.name);
                let own = canonical::unit_in_name(&column.name).map(str::to_owned);
                let unit = column.unit.as_ref().or(own.as_ref());
                place(file, column, known.name, Some(known), unit, Taken::Guessed)?
            }
            None => place(file, column, &column.name, None, column.unit.as_ref(), Taken::Kept)?,
        });
    }
    let columns: Vec<Column> = columns.into_iter().flatten().collect();
    no_name_twice(file, &columns)?;
    let time = columns.iter().position(|column| column.note.signal == "time");
    Ok(Header { columns, time })
}

/// Whether a column of that text will be the time.
pub(crate) fn is_time(text: &str, maps: &[Mapping]) -> bool {
    let given = [split(text)];
    match maps.iter().find(|map| map.canonical == "time") {
        Some(map) => find(&given, &map.foreign).is_some(),
        None => {
            let Given { name, unit, .. } = &given[0];
            let guess = || canonical::guess(name, unit.as_deref());
            canonical::exact(name).or_else(guess).is_some_and(|known| known.name == "time")
        }
    }
}

/// The error of a file in which no column is the time.
pub(crate) fn missing_time(file: &str, texts: &[String]) -> Error {
    let given: Vec<Given> = texts.iter().map(|text| split(text)).collect();
    Error::MissingTime { file: file.to_owned(), columns: listed(&given) }
}

/// The column under its signal's name, in SI if the signal is known and keeps no unit of its own.
fn place(
    file: &str,
    given: &Given,
    signal: &str,
    known_as: Option<&Canonical>,
    unit: Option<&String>,
    taken: Taken,
) -> Result<Column, Error> {
    let (unit_text, conversion) = match (known_as, unit) {
        (None, unit) => (unit.map_or("1", String::as_str), None),
        (Some(canonical), None) => (canonical.bare_unit, None),
        (Some(canonical), Some(text)) => {
            let unit = Unit::parse(text)
                .filter(|unit| canonical.quantities.contains(&unit.quantity))
                .ok_or_else(|| Error::UnknownUnit {
                    file: file.to_owned(),
                    column: given.name.clone(),
                    signal: signal.to_owned(),
                    unit: text.clone(),
                    known: known(canonical.quantities),
                })?;
            if canonical.keeps_unit {
                (text.as_str(), None)
            } else {
                (unit.quantity.si(), Some(unit).filter(|unit| !unit.is_si()))
            }
        }
    };
    let note = ColumnNote {
        column: given.name.clone(),
        given_unit: unit.cloned(),
        signal: signal.to_owned(),
        unit: unit_text.to_owned(),
        taken,
        converted: conversion.is_some(),
    };
    Ok(Column { note, conversion })
}

fn no_name_twice(file: &str, columns: &[Column]) -> Result<(), Error> {
    for (k, column) in columns.iter().enumerate() {
        let name = &column.note.signal;
        if let Some(other) = columns[..k].iter().find(|other| other.note.signal == *name) {
            return Err(Error::DuplicateSignal {
                file: file.to_owned(),
                name: name.clone(),
                first: other.note.column.clone(),
                second: column.note.column.clone(),
            });
        }
    }
    Ok(())
}

/// By its name, by the header's whole text, then without regard to case.
fn find(given: &[Given], wanted: &str) -> Option<usize> {
    given
        .iter()
        .position(|column| column.name == wanted || column.text == wanted)
        .or_else(|| given.iter().position(|column| column.name.eq_ignore_ascii_case(wanted)))
}

fn listed(given: &[Given]) -> String {
    given.iter().map(|column| format!("`{}`", column.name)).collect::<Vec<_>>().join(", ")
}

/// `name [unit]`, `name (unit)`, `name/unit`, `name_unit` or a bare name.
fn split(text: &str) -> Given {
    let text = text.trim();
    let made = |name: &str, unit: &str| Given {
        text: text.to_owned(),
        name: name.trim().to_owned(),
        unit: Some(unit.trim().to_owned()),
    };
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inside) = text.strip_suffix(close)
            && let Some((name, unit)) = inside.rsplit_once(open)
            && !name.trim().is_empty()
        {
            return made(name, unit);
        }
    }
    if let Some((name, unit)) = text.split_once('/') {
        let named =
            canonical::exact(name.trim()).is_some() || canonical::guess(name, None).is_some();
        if !name.trim().is_empty() && (named || Unit::parse(unit).is_some()) {
            return made(name, unit);
        }
    }
    // `speed_rpm`: only where word and unit fit each other, so that `I_m` stays a name.
    if canonical::exact(text).is_none()
        && let Some((name, unit)) = text.rsplit_once('_')
        && canonical::guess(name, Some(unit)).is_some()
    {
        return made(name, unit);
    }
    Given { text: text.to_owned(), name: text.to_owned(), unit: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(texts: &[&str], maps: &str) -> Result<Header, Error> {
        let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
        resolve("a.csv", &texts, &Mapping::parse_list(maps).unwrap())
    }

    /// `column -> signal [unit]` of every column.
    fn told(texts: &[&str], maps: &str) -> Vec<String> {
        let told = |it: &Column| format!("{} [{}]", it.note.signal, it.note.unit);
        header(texts, maps).unwrap().columns.iter().map(told).collect()
    }

    #[test]
    fn four_header_forms_and_the_bare_name() {
        let texts = ["time [ms]", "u (mV)", "omega/rpm", "pos_mm", "i"];
        let read = header(&texts, "").unwrap();
        assert_eq!(told(&texts, ""), ["time [s]", "u [V]", "omega [rad/s]", "x [m]", "i [A]"]);
        assert_eq!(read.time, Some(0));
        assert_eq!(read.columns[0].convert(1.0), 0.001);
        assert_eq!(read.columns[3].note.taken, Taken::Guessed);
        assert_eq!(read.columns[4].convert(2.5), 2.5);
    }

    #[test]
    fn sensors_and_inputs_keep_what_they_are_in() {
        assert_eq!(told(&["time", "T [rpm]"], "")[1], "T [rpm]");
        assert_eq!(told(&["time", "T"], "")[1], "T [rpm]");
        assert_eq!(told(&["time", "T [degC]"], "")[1], "temperature [K]");
        for (unit, si) in [("mA", "A"), ("kN", "N"), ("mN m", "N m"), ("V", "V")] {
            assert_eq!(told(&["time", &format!("u [{unit}]")], "")[1], format!("u [{si}]"));
        }
        assert_eq!(told(&["time", "I_m", "C_m"], "")[1..], ["I_m [A]", "C_m [V]"]);
    }

    #[test]
    fn foreign_names_give_way_to_exact_ones_and_to_mappings() {
        assert_eq!(told(&["t", "Speed [rpm]", "omega"], "")[1..], ["Speed [rpm]", "omega [rad/s]"]);
        let mapped = told(&["t", "Speed", "omega"], "omega=Speed:rpm,omega_2=omega");
        assert_eq!(mapped[1..], ["omega [rad/s]", "omega_2 [1]"]);
        assert_eq!(told(&["t", "vibration (g)"], "")[1], "vibration [g]");
        assert_eq!(told(&["Timestamp", "V [m/s]", "V_ref"], "")[1..], ["v [m/s]", "V_ref [1]"]);
        assert_eq!(told(&["t", "n"], "")[1], "omega [rad/s]");
        assert!(header(&["t", "n"], "").unwrap().columns[1].note.converted);
    }

    #[test]
    fn what_cannot_be_is_refused_with_the_next_step() {
        let error = |texts: &[&str], maps: &str| header(texts, maps).unwrap_err().to_string();
        let unit = error(&["time", "omega [furlong]"], "");
        assert!(unit.contains("`furlong`") && unit.contains("rpm"), "{unit}");
        assert!(error(&["time", "theta [V]"], "").contains("no unit of theta"));
        assert!(error(&["time", "u", "u"], "").contains("columns 2 and 3"));
        assert!(error(&["time", "u [V]", "u [mV]"], "").contains("columns 2 and 3"));
        assert!(error(&["time", "a", "u"], "u=a").contains("both column `a` and column `u`"));
        assert!(error(&["time", "a"], "u=b").contains("it has `time`, `a`"));
    }
}
