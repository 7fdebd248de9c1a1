//! A header's text parted into name and unit.

use drivescope_units::{Unit, is_counts};

use crate::canonical;
use crate::guess;

/// A header's text split into name and unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Given {
    pub(crate) text: String,
    pub(crate) name: String,
    pub(crate) unit: Option<String>,
}

impl Given {
    /// Reads `name [unit]` in any brackets, `name/unit`, `name, unit`, `name in unit`,
    /// `name unit`, `name_unit` or a bare name.
    pub(crate) fn of(text: &str) -> Given {
        let text = text.trim();
        let made = |name: &str, unit: &str| Given {
            text: text.to_owned(),
            name: name.trim().to_owned(),
            unit: Some(unit.trim().to_owned()),
        };
        if let Some((name, unit)) = bracketed(text) {
            return made(&name, unit);
        }
        if canonical::exact(text).is_some() {
            return Given { text: text.to_owned(), name: text.to_owned(), unit: None };
        }
        if let Some((name, unit)) = text.split_once(" in ")
            && is_unit(unit)
        {
            return made(name, unit);
        }
        // `omega_deg/s` and `speed 1/min`: a slash in a unit parts nothing.
        let marked = marked(text);
        if let Some((name, unit)) = marked.filter(|(_, unit)| unit.contains('/')) {
            return made(name, unit);
        }
        if let Some((name, unit)) = text.split_once('/') {
            let named =
                canonical::exact(name.trim()).is_some() || guess::guess(name, None, None).is_some();
            if !name.trim().is_empty() && (named || is_unit(unit)) {
                return made(name, unit);
            }
        }
        match marked {
            Some((name, unit)) => made(name, unit),
            None => Given { text: text.to_owned(), name: text.to_owned(), unit: None },
        }
    }
}

/// Name and unit where a comma, a blank or an underscore parts them.
fn marked(text: &str) -> Option<(&str, &str)> {
    let part = |mark| text.rsplit_once(mark);
    let whole = |(name, unit): &(&str, &str)| {
        is_unit(unit) && !unit.trim().is_empty() && !name.trim().is_empty()
    };
    let comma = || part(',').filter(whole);
    let blank = || part(' ').filter(whole).filter(|(name, unit)| fits(name.trim(), unit));
    // `speed_rad_s`: only where word and unit fit each other, so that `I_m` stays a name.
    let underscores = || text.match_indices('_').map(|(at, _)| (&text[..at], &text[at + 1..]));
    let underscore = || underscores().find(|(name, unit)| fits(name, unit));
    comma().or_else(blank).or_else(underscore)
}

/// Whether a signal of that name can be in that unit.
fn fits(name: &str, unit: &str) -> bool {
    // `run 1` and `omega_1` are numbered, not dimensionless.
    let number = unit.bytes().all(|byte| byte.is_ascii_digit());
    if name.is_empty() || unit.trim().is_empty() || number || !is_unit(unit) {
        return false;
    }
    match canonical::exact(name) {
        Some(known) if known.accepts(unit) => true,
        Some(known) if name != "T" => {
            is_counts(unit) && known.accepts("rad") || { is_counts(unit) && known.accepts("m") }
        }
        _ if is_counts(unit) => guess::guess(name, None, None).is_some(),
        _ => guess::guess(name, Some(unit), None).is_some(),
    }
}

fn is_unit(text: &str) -> bool {
    Unit::parse(text.trim()).is_some() || is_counts(text)
}

/// The unit in brackets at the end, or a known one in brackets anywhere, and the text around it.
fn bracketed(text: &str) -> Option<(String, &str)> {
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')] {
        let Some(end) = text.rfind(close) else { continue };
        let inside = text[..end].char_indices().rev().scan(1_usize, |depth, (at, c)| {
            *depth = if c == close { *depth + 1 } else { *depth - usize::from(c == open) };
            Some((at, *depth))
        });
        let Some((start, _)) = inside.into_iter().find(|(_, depth)| *depth == 0) else { continue };
        let (name, unit) = (text[..start].trim(), &text[start + open.len_utf8()..end]);
        let after = text[end + close.len_utf8()..].trim();
        // `log{1}` and `u(2)` are elements; a dimensionless unit stands in square brackets.
        let element = open != '[' && unit.bytes().all(|byte| byte.is_ascii_digit());
        if name.is_empty() || element || !after.is_empty() && !is_unit(unit) {
            continue;
        }
        return Some((format!("{name} {after}").trim().to_owned(), unit));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stand_in_every_place() {
        for (text, name, unit) in [
            ("speed [rpm]", "speed", Some("rpm")),
            ("speed (rpm)", "speed", Some("rpm")),
            ("speed {rpm}", "speed", Some("rpm")),
            ("speed <rpm>", "speed", Some("rpm")),
            ("theta [counts(4096)]", "theta", Some("counts(4096)")),
            ("theta (counts(4096))", "theta", Some("counts(4096)")),
            ("speed (rpm) actual", "speed actual", Some("rpm")),
            ("pump (left) [bar]", "pump (left)", Some("bar")),
            ("speed/rpm", "speed", Some("rpm")),
            ("Speed, rpm", "Speed", Some("rpm")),
            ("Drehzahl in U/min", "Drehzahl", Some("U/min")),
            ("Winkel in Grad", "Winkel", Some("Grad")),
            ("Speed rpm", "Speed", Some("rpm")),
            ("speed_rad_s", "speed", Some("rad_s")),
            ("speed_rad_per_s", "speed", Some("rad_per_s")),
            ("torque_N_m", "torque", Some("N_m")),
            ("motor_speed_1_min", "motor_speed", Some("1_min")),
            ("time_ms", "time", Some("ms")),
            ("theta_counts", "theta", Some("counts")),
            ("omega_°/s", "omega", Some("°/s")),
            ("motor_speed_1/min", "motor_speed", Some("1/min")),
            ("Speed rad/s", "Speed", Some("rad/s")),
            ("Speed, rad/s", "Speed", Some("rad/s")),
            ("omega/rad_s", "omega", Some("rad_s")),
            ("torque/N m", "torque", Some("N m")),
            ("theta_m/rad", "theta_m", Some("rad")),
            ("I_m", "I_m", None),
            ("x_load", "x_load", None),
            ("theta_m", "theta_m", None),
            ("omega", "omega", None),
            ("Datum/Zeit", "Datum/Zeit", None),
            ("run 1", "run 1", None),
        ] {
            let expected = Given {
                text: text.to_owned(),
                name: name.to_owned(),
                unit: unit.map(str::to_owned),
            };
            assert_eq!(Given::of(text), expected, "{text}");
        }
    }
}
