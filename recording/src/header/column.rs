//! A column under its signal's name and in its unit.

use drivescope_units::Unit;
use serde::Serialize;

use crate::canonical::Canonical;
use crate::error::Error;
use crate::given::Given;

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

    /// Gives a column without a unit the one that its values turned out to be in.
    pub(crate) fn take_unit(&mut self, unit: &str) {
        self.conversion = Unit::parse(unit).filter(|unit| !unit.is_si());
        self.note.given_unit = Some(unit.to_owned());
        self.note.converted = self.conversion.is_some();
    }

    pub(crate) fn convert_all(&self, values: &mut [f64]) {
        if let Some(unit) = self.conversion {
            values.iter_mut().for_each(|value| *value = unit.to_si(*value));
        }
    }
}

/// The column under its signal's name, in SI if the signal is known and keeps no unit of its own.
pub(super) fn place(
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
                    known: Unit::spelt(canonical.quantities),
                })?;
            if canonical.kept.contains(&unit.quantity) {
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
