//! Counts of an encoder as a unit of angle or length.

use std::f64::consts::PI;

use crate::quantity::Quantity;
use crate::table::{listed, normalized};
use crate::unit::Unit;

/// Whether a unit is counts without a word how many make a revolution or a length.
pub fn is_counts(text: &str) -> bool {
    COUNTS.iter().any(|word| normalized(text).eq_ignore_ascii_case(word))
}

/// Words for the steps of an encoder, longer ones before those they begin with.
const COUNTS: &[&str] = &[
    "counts",
    "count",
    "cnts",
    "cnt",
    "increments",
    "increment",
    "inkremente",
    "incr",
    "incs",
    "inc",
    "ticks",
    "tick",
    "pulses",
    "pulse",
    "impulse",
    "cuentas",
];

/// Counts of an encoder: `counts/4096`, `counts(4096)`, `counts 4096/rev`, `counts/rev 4096`,
/// `4096 counts/rev`, `counts/mm 1000`, `counts*0.05um`.
pub(crate) fn counted(text: &str) -> Option<Unit> {
    let lower = text.to_ascii_lowercase();
    let word = COUNTS.iter().find(|word| lower.contains(**word))?;
    let at = lower.find(word)?;
    let (before, after) = (text.get(..at)?, text.get(at + word.len()..)?);
    let rest = format!("{before} {after}").replace(['(', ')', '/', '_', ':', '='], " ");
    let number = |text: &str| text.parse::<f64>().ok().filter(|it| it.is_finite() && *it > 0.0);
    let mut of = (Quantity::Angle, 2.0 * PI, 1.0);
    // A dot or star between count and length was made a blank: what follows is a number and a
    // unit in one word or two.
    let (mut counts, mut length) = (None, None);
    for part in rest.split_whitespace().filter(|part| *part != "per") {
        let digits = part.find(|c: char| c.is_alphabetic() && !"eE".contains(c));
        let (value, unit) = part.split_at(digits.unwrap_or(part.len()));
        if !value.is_empty() {
            counts = Some(number(value)?);
        }
        if !unit.is_empty() {
            length = Some(
                listed(unit)
                    .filter(|it| matches!(it.quantity, Quantity::Angle | Quantity::Length))?,
            );
        }
    }
    let counts = counts?;
    if let Some(unit) = length {
        of = (unit.quantity, unit.numerator, unit.denominator);
    }
    let (quantity, numerator, denominator) = of;
    // `counts*0.05um` and `counts 0.05 um`: the size of one; else how many make the unit.
    let size = !after.contains('/') && !before.contains('/') && length.is_some();
    let (numerator, denominator) = match size {
        true => (numerator * counts, denominator),
        false => (numerator, denominator * counts),
    };
    Some(Unit { quantity, numerator, denominator, offset: 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_become_angles_and_lengths() {
        let of = |text: &str, value: f64| {
            let unit = Unit::parse(text).unwrap_or_else(|| panic!("{text}"));
            (unit.quantity, unit.to_si(value))
        };
        for text in [
            "counts/4096",
            "counts(4096)",
            "counts 4096/rev",
            "counts/rev 4096",
            "4096 counts/rev",
            "cnt/4096",
            "inc 4096",
            "ticks_4096",
            "pulses/4096",
            "counts:4096",
        ] {
            assert_eq!(of(text, 4096.0), (Quantity::Angle, 2.0 * PI), "{text}");
        }
        for text in ["counts/mm 1000", "counts 1000/mm", "counts*1um", "counts*0.001mm"] {
            let (quantity, value) = of(text, 5e5);
            assert_eq!(quantity, Quantity::Length, "{text}");
            // Decimal factors are rounded once or twice on the way.
            assert!((value - 0.5).abs() < 2.0 * f64::EPSILON, "{text}: {value}");
        }
        assert!((of("counts*0.05um", 1e6).1 - 0.05).abs() < 1e-16);
        assert!(is_counts("Counts") && is_counts("inc") && !is_counts("counts/4096"));
    }
}
