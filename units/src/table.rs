//! The one table of units: spellings, quantity, and the fraction and offset that lead to SI.

use std::f64::consts::PI;

use crate::quantity::Quantity;
use crate::unit::Unit;

/// Spellings, quantity, numerator, denominator, offset.
pub(crate) type Row = (&'static [&'static str], Quantity, f64, f64, f64);

pub(crate) const TABLE: &[Row] = &[
    (
        &["s", "sec", "second", "seconds", "sek", "sekunden", "secondes", "segundos", "secondi"],
        Quantity::Time,
        1.0,
        1.0,
        0.0,
    ),
    (&["ms", "msec", "millis", "millisecond", "milliseconds"], Quantity::Time, 1.0, 1e3, 0.0),
    (&["us", "usec", "micros", "microseconds"], Quantity::Time, 1.0, 1e6, 0.0),
    (&["ns", "nsec", "nanoseconds"], Quantity::Time, 1.0, 1e9, 0.0),
    (&["min", "minutes", "minuten"], Quantity::Time, 60.0, 1.0, 0.0),
    (&["h", "hours", "stunden"], Quantity::Time, 3600.0, 1.0, 0.0),
    (&["V", "volt", "volts", "voltios"], Quantity::Voltage, 1.0, 1.0, 0.0),
    (&["mV"], Quantity::Voltage, 1.0, 1e3, 0.0),
    (&["kV"], Quantity::Voltage, 1e3, 1.0, 0.0),
    (&["A", "amp", "amps", "ampere", "amperes", "amperios"], Quantity::Current, 1.0, 1.0, 0.0),
    (&["mA"], Quantity::Current, 1.0, 1e3, 0.0),
    (&["uA"], Quantity::Current, 1.0, 1e6, 0.0),
    (&["kA"], Quantity::Current, 1e3, 1.0, 0.0),
    (&["rad/s", "rad/sec", "rad s^-1", "rad s-1", "rads"], Quantity::AngularSpeed, 1.0, 1.0, 0.0),
    (
        &[
            "rpm",
            "1/min",
            "r/min",
            "rev/min",
            "U/min",
            "min^-1",
            "min-1",
            "upm",
            "tr/min",
            "tours/min",
            "giri/min",
            "vueltas/min",
            "Umdr/min",
            "Umdrehungen/min",
            "r.p.m.",
            "turns/min",
        ],
        Quantity::AngularSpeed,
        PI,
        30.0,
        0.0,
    ),
    (&["krpm", "k rpm"], Quantity::AngularSpeed, 1e3 * PI, 30.0, 0.0),
    (
        &["deg/s", "deg/sec", "dps", "Grad/s", "deg s-1", "deg s^-1"],
        Quantity::AngularSpeed,
        PI,
        180.0,
        0.0,
    ),
    (
        &["rev/s", "rps", "r/s", "U/s", "tr/s", "giri/s", "vueltas/s", "turns/s", "turn/s"],
        Quantity::AngularSpeed,
        2.0 * PI,
        1.0,
        0.0,
    ),
    (&["m/s", "m/sec", "m s^-1", "m s-1"], Quantity::Speed, 1.0, 1.0, 0.0),
    (&["mm/s", "mm/sec"], Quantity::Speed, 1.0, 1e3, 0.0),
    (&["um/s"], Quantity::Speed, 1.0, 1e6, 0.0),
    (&["cm/s"], Quantity::Speed, 1.0, 1e2, 0.0),
    (&["m/min"], Quantity::Speed, 1.0, 60.0, 0.0),
    (&["mm/min"], Quantity::Speed, 1.0, 6e4, 0.0),
    (&["rad"], Quantity::Angle, 1.0, 1.0, 0.0),
    (&["mrad"], Quantity::Angle, 1.0, 1e3, 0.0),
    (
        &["deg", "degree", "degrees", "Grad", "degres", "degrés", "grados", "gradi"],
        Quantity::Angle,
        PI,
        180.0,
        0.0,
    ),
    (
        &[
            "rev",
            "turn",
            "turns",
            "revs",
            "revolutions",
            "Umdr",
            "Umdrehungen",
            "tr",
            "tours",
            "vueltas",
            "giri",
        ],
        Quantity::Angle,
        2.0 * PI,
        1.0,
        0.0,
    ),
    (&["m", "meter", "metre", "meters", "metres"], Quantity::Length, 1.0, 1.0, 0.0),
    (&["cm"], Quantity::Length, 1.0, 1e2, 0.0),
    (&["mm"], Quantity::Length, 1.0, 1e3, 0.0),
    (&["um"], Quantity::Length, 1.0, 1e6, 0.0),
    (&["nm"], Quantity::Length, 1.0, 1e9, 0.0),
    (&["N m", "Nm", "N-m", "N.m", "newton meter"], Quantity::Torque, 1.0, 1.0, 0.0),
    (&["mN m", "mNm", "mN-m", "mN.m", "N mm", "Nmm"], Quantity::Torque, 1.0, 1e3, 0.0),
    (&["uN m", "uNm"], Quantity::Torque, 1.0, 1e6, 0.0),
    (&["N cm", "Ncm", "cN m", "cNm"], Quantity::Torque, 1.0, 1e2, 0.0),
    (&["kN m", "kNm"], Quantity::Torque, 1e3, 1.0, 0.0),
    (&["N", "newton"], Quantity::Force, 1.0, 1.0, 0.0),
    (&["mN"], Quantity::Force, 1.0, 1e3, 0.0),
    (&["kN"], Quantity::Force, 1e3, 1.0, 0.0),
    (&["K", "kelvin"], Quantity::Temperature, 1.0, 1.0, 0.0),
    (
        &["degC", "C", "celsius", "deg C", "deg_C", "Grad C"],
        Quantity::Temperature,
        1.0,
        1.0,
        273.15,
    ),
    (&["1", "-", "none", ""], Quantity::Dimensionless, 1.0, 1.0, 0.0),
    (&["%", "percent"], Quantity::Dimensionless, 1.0, 1e2, 0.0),
];

/// The unit of exactly that text, or in another case where that carries no meaning.
pub(crate) fn listed(text: &str) -> Option<Unit> {
    let found = TABLE.iter().find(|row| row.0.contains(&text)).or_else(|| {
        let folded = |alias: &&str| alias.len() > 2 && alias.eq_ignore_ascii_case(text);
        TABLE.iter().find(|row| row.0.iter().any(folded))
    });
    found.map(|&(_, quantity, numerator, denominator, offset)| Unit {
        quantity,
        numerator,
        denominator,
        offset,
    })
}

/// Micro signs, degree signs, product dots, minus signs and runs of blanks as the table has them.
pub(crate) fn normalized(text: &str) -> String {
    let plain = text
        .replace(['µ', 'μ'], "u")
        .replace(['°', 'º'], "deg")
        .replace(['·', '*', '⋅'], " ")
        .replace("⁻¹", "^-1")
        .replace('\u{2212}', "-");
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_spelling_stands_twice() {
        let all: Vec<&str> = TABLE.iter().flat_map(|row| row.0.iter().copied()).collect();
        for (k, text) in all.iter().enumerate() {
            assert!(!all[..k].contains(text), "`{text}` is listed twice");
        }
    }
}
