//! A drive file with other values of some parameters: comments, order and layout stay.

use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

use super::error::DriveFileError;
use crate::drive::Drive;

/// A parameter's new value and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The parameter (`R`, `coulomb.T_c`).
    pub name: String,
    /// Its new value, SI.
    pub value: f64,
    /// What stands in `[origin]` from now on.
    pub origin: String,
}

/// Significant digits of a written value: more than any recording tells.
const DIGITS: usize = 8;

impl Drive {
    /// The text of a drive file with these values, and the drive that it describes; `file_name`
    /// is only for the error. Parameters that the drive does not have are left out.
    ///
    /// # Errors
    /// [`DriveFileError::Content`] if the text, before or after, is no right drive file.
    pub fn edited(
        text: &str,
        file_name: &str,
        changes: &[Change],
    ) -> Result<(String, Self), DriveFileError> {
        let before = Self::parse(text, file_name)?;
        let Ok(mut document) = text.parse::<DocumentMut>() else {
            // Both read the same language: what one takes, the other does.
            return Ok((text.to_owned(), before));
        };
        for change in changes {
            if let Some(table) = table_of(&mut document, &before, &change.name) {
                let key = change.name.rsplit('.').next().unwrap_or(&change.name);
                put(table, key, number(change.value));
                let origin = origin(&mut document);
                put(origin, &change.name, Value::from(change.origin.as_str()));
            }
        }
        let text = document.to_string();
        let after = Self::parse(&text, file_name)?;
        Ok((text, after))
    }
}

/// The table in which a parameter stands, or would stand.
fn table_of<'d>(
    document: &'d mut DocumentMut,
    drive: &Drive,
    name: &str,
) -> Option<&'d mut dyn TableLike> {
    let Some((id, key)) = name.split_once('.') else {
        return document.get_mut("motor")?.as_table_like_mut();
    };
    let number = drive.effects.iter().position(|effect| effect.id == id)?;
    let typed = drive.effects[number].law.is_some();
    if !drive.effects[number].parameters.iter().any(|(name, _)| name == key) {
        return None;
    }
    let effects = document.get_mut("effect")?;
    let effect: &mut dyn TableLike = match effects {
        Item::ArrayOfTables(tables) => tables.get_mut(number)?,
        Item::Value(Value::Array(list)) => list.get_mut(number)?.as_inline_table_mut()?,
        _ => return None,
    };
    if typed { effect.get_mut("parameters")?.as_table_like_mut() } else { Some(effect) }
}

/// The table `[origin]`, at the end where there is none.
fn origin(document: &mut DocumentMut) -> &mut dyn TableLike {
    let item = document.entry("origin").or_insert_with(|| Item::Table(Table::new()));
    if !item.is_table_like() {
        *item = Item::Table(Table::new());
    }
    item.as_table_like_mut().expect("it was made one")
}

/// Puts a value in place of the one there is, with the blanks and the comment around that.
fn put(table: &mut dyn TableLike, key: &str, mut value: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(there) => {
            *value.decor_mut() = there.decor().clone();
            *there = value;
        }
        None => drop(table.insert(key, Item::Value(value))),
    }
}

/// The number in the shorter of its two notations.
fn number(value: f64) -> Value {
    let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
    let (plain, powers) = (format!("{rounded:?}"), format!("{rounded:e}"));
    let text = if powers.len() < plain.len() { powers } else { plain };
    text.parse().unwrap_or_else(|_| Value::from(rounded))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::DR300;

    fn change(name: &str, value: f64) -> Change {
        Change { name: name.to_owned(), value, origin: format!("fitted: {name}") }
    }

    #[test]
    fn only_the_values_change() {
        let changes =
            [change("R", 3.25), change("J", 8.123456789e-5), change("stribeck.omega_s", 4.5)];
        let (text, drive) = Drive::edited(DR300, "dr300.toml", &changes).expect("right");
        assert_eq!((drive.motor.r, drive.motor.j), (Some(3.25), 8.1234568e-5));
        assert_eq!(drive.origin["stribeck.omega_s"], "fitted: stribeck.omega_s");
        assert_eq!(drive.origin["L"], "assumed");
        let differing: Vec<_> = DR300.lines().zip(text.lines()).filter(|(a, b)| a != b).collect();
        assert_eq!(differing.len(), 6, "three values and three origins: {differing:?}");
        assert!(text.contains("R = 3.25                           # ohm"), "{text}");
        assert!(text.contains("J = 8.1234568e-5 "), "{text}");
    }

    #[test]
    fn typed_laws_inline_tables_and_a_missing_origin_are_served() {
        let text = "effect = [{ kind = \"coulomb\", T_c = 0.01 }, { kind = \"custom\", id = \"a\", \
                    torque = \"-c * omega\", parameters = { c = 1e-3 } }]\n\
                    [motor]\nR = 1 # a comment\nL = 1e-3\nK_e = 0.05\nK_m = 0.05\nJ = 1e-4\nB_m = 0\n";
        let changes = [
            change("a.c", 2e-3),
            change("coulomb.T_c", 0.02),
            change("R", 2.0),
            change("a.x", 1.0),
        ];
        let (text, drive) = Drive::edited(text, "inline.toml", &changes).expect("right");
        assert_eq!(drive.motor.r, Some(2.0));
        assert_eq!(drive.effects[0].parameters[0].1, 0.02);
        assert_eq!(drive.effects[1].parameters[0].1, 2e-3);
        assert_eq!(drive.origin.len(), 3, "a coefficient that the law does not have is left out");
        assert!(text.contains("# a comment"), "{text}");
    }

    #[test]
    fn what_is_no_drive_file_is_refused() {
        assert!(Drive::edited("motor = 1", "x.toml", &[]).is_err());
        let impossible = Drive::edited(DR300, "x.toml", &[change("R", -1.0)]);
        assert!(impossible.expect_err("not possible").to_string().starts_with("x.toml:9:"));
    }
}
