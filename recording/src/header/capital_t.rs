//! What a column called `T` without a unit is.

use super::column::{Column, Taken, place};
use crate::canonical;
use crate::error::Error;
use crate::given::Given;
use crate::guess;
use crate::look::Look;

/// A column called `T` without a unit: the tachometer beside the other signals of a bench, a
/// temperature where its values are like one, and otherwise whatever a user says.
pub(super) fn capital_t(
    file: &str,
    given: &[Given],
    k: usize,
    look: Option<&Look>,
    used: &[&str],
) -> Result<(Column, Option<String>), Error> {
    let is = |names: &[&str]| {
        let named = |other: &Given| {
            let guess = || guess::guess(&other.name, other.unit.as_deref(), None);
            let known = canonical::exact(&other.name).or_else(|| Some(guess()?.canonical));
            known.is_some_and(|known| names.contains(&known.name))
        };
        given.iter().enumerate().any(|(other, column)| other != k && named(column))
    };
    let column = &given[k];
    let other_speed = is(&["omega", "v"]);
    if is(&["C_m", "I_m"]) && !other_speed && !used.contains(&"T") {
        return Ok((place(file, column, "T", canonical::exact("T"), None, Taken::Named)?, None));
    }
    let warm = look.is_some_and(|look| look.like_degrees);
    if warm && !is(&["temperature"]) && !used.contains(&"temperature") {
        let (known, unit) = (canonical::exact("temperature"), Some("degC".to_owned()));
        return Ok((
            place(file, column, "temperature", known, unit.as_ref(), Taken::Guessed)?,
            Some("column `T` moves as a temperature in degC does".to_owned()),
        ));
    }
    let note = "column `T` may be a tachometer, a torque or a temperature: it is kept as it is; \
                say which with --columns T=T:rpm, torque=T:Nm or temperature=T:degC";
    Ok((place(file, column, "T", None, None, Taken::Kept)?, Some(note.to_owned())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::header::resolve;
    use crate::mapping::ReadOptions;

    #[test]
    fn a_capital_t_alone_is_what_its_values_and_neighbours_say() {
        let stated = |texts: &[&str], looks: &[Look]| {
            let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
            let header = resolve("a.csv", &texts, &ReadOptions::default(), looks).unwrap();
            let column = header.columns.last().unwrap().note.clone();
            (format!("{} [{}]", column.signal, column.unit), header.notes.concat())
        };
        let warm = [Look { like_degrees: true, ..Look::default() }; 2];
        assert_eq!(stated(&["time", "T"], &warm).0, "temperature [K]");
        let (kept, note) = stated(&["time", "T"], &[]);
        assert!(kept == "T [1]" && note.contains("--columns T=T:rpm"), "{kept}: {note}");
        // Beside a speed it is no tachometer, not even on a bench.
        assert_eq!(stated(&["time", "omega", "C_m", "T"], &[]).0, "T [1]");
        for (text, signal) in [
            ("T [Nm]", "torque [N m]"),
            ("T_Nm", "torque [N m]"),
            ("T [rad/s]", "T [rad/s]"),
            ("T [V]", "T [V]"),
            ("T [K]", "temperature [K]"),
        ] {
            assert_eq!(stated(&["time", text], &[]).0, signal, "{text}");
        }
        for (text, signal) in
            [("C_m [1]", "C_m [1]"), ("C_m [%]", "C_m [%]"), ("C_m [mV]", "C_m [V]")]
        {
            assert_eq!(stated(&["time", text], &[]).0, signal, "{text}");
        }
    }
}
