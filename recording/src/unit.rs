//! Units that a column's header may carry, and their way to SI.
//!
//! `SI value = value * numerator / denominator + offset`. Factors are kept as a fraction, because
//! `1 / 1000` is rounded once and `* 0.001` twice: 1 ms becomes exactly the number that `0.001`
//! is read as.

use std::f64::consts::PI;

use serde::Serialize;

use crate::counts::counted;

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Duration; SI unit s.
    Time,
    /// Electric tension; SI unit V.
    Voltage,
    /// Electric current; SI unit A.
    Current,
    /// Speed of rotation; SI unit rad/s.
    AngularSpeed,
    /// Speed of translation; SI unit m/s.
    Speed,
    /// Angle; SI unit rad.
    Angle,
    /// Position; SI unit m.
    Length,
    /// Torque; SI unit N m.
    Torque,
    /// Force; SI unit N.
    Force,
    /// Absolute temperature; SI unit K.
    Temperature,
    /// A number without a unit, written `1`.
    Dimensionless,
}

impl Quantity {
    /// The SI unit as it is written in a column header.
    pub fn si(self) -> &'static str {
        match self {
            Quantity::Time => "s",
            Quantity::Voltage => "V",
            Quantity::Current => "A",
            Quantity::AngularSpeed => "rad/s",
            Quantity::Speed => "m/s",
            Quantity::Angle => "rad",
            Quantity::Length => "m",
            Quantity::Torque => "N m",
            Quantity::Force => "N",
            Quantity::Temperature => "K",
            Quantity::Dimensionless => "1",
        }
    }
}

/// A known unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub quantity: Quantity,
    pub(crate) numerator: f64,
    pub(crate) denominator: f64,
    pub(crate) offset: f64,
}

impl Unit {
    /// Looks a unit up by the text of a header: `rpm`, `1/min`, `N·m`, `µm`, `rad_per_s`,
    /// `counts/4096` (counts a revolution), `counts*0.05um`, ...
    ///
    /// Case counts where it carries meaning (`mV`, `MV`); texts of three letters and more that
    /// are known in one case only are also found in another (`RPM`).
    pub fn parse(text: &str) -> Option<Unit> {
        let text = normalized(text);
        let parted =
            |mark: &str| text.replace("_per_", "/").replace(" per ", "/").replace('_', mark);
        listed(&text)
            .or_else(|| counted(&text))
            .or_else(|| listed(&parted("/")))
            .or_else(|| listed(&parted(" ")))
    }

    /// The value in the quantity's SI unit.
    pub fn to_si(self, value: f64) -> f64 {
        // The identity leaves every bit alone, the sign of a zero too.
        if self.is_si() { value } else { value * self.numerator / self.denominator + self.offset }
    }

    /// Whether the unit is the SI unit itself.
    pub fn is_si(self) -> bool {
        self.numerator == self.denominator && self.offset == 0.0
    }
}

impl Quantity {
    /// The units that a column of this quantity may be in, as they are spelt first.
    pub fn units(self) -> impl Iterator<Item = &'static str> {
        TABLE.iter().filter(move |row| row.1 == self).map(|row| row.0[0])
    }
}

/// Every text known for units of the given quantities (the first spelling of each), for messages.
pub(crate) fn known(quantities: &[Quantity]) -> String {
    let rows = TABLE.iter().filter(|row| quantities.contains(&row.1));
    let mut names: Vec<&str> = rows.map(|row| row.0[0]).collect();
    if quantities.contains(&Quantity::Angle) {
        names.push("counts/4096 (counts a revolution)");
    }
    if quantities.contains(&Quantity::Length) {
        names.push("counts*0.05um (length of a count)");
    }
    names.join(", ")
}

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

/// Micro signs, degree signs, product dots, minus signs and runs of blanks in one spelling.
pub(crate) fn normalized(text: &str) -> String {
    let plain = text
        .replace(['µ', 'μ'], "u")
        .replace(['°', 'º'], "deg")
        .replace(['·', '*', '⋅'], " ")
        .replace("⁻¹", "^-1")
        .replace('\u{2212}', "-");
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Spellings, quantity, numerator, denominator, offset.
type Row = (&'static [&'static str], Quantity, f64, f64, f64);

const TABLE: &[Row] = &[
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_millisecond_is_the_number_written_as_one_thousandth() {
        for k in 0..100_000 {
            let text = format!("{}.{:03}", k / 1000, k % 1000);
            let expected: f64 = text.parse().unwrap();
            assert_eq!(Unit::parse("ms").unwrap().to_si(f64::from(k)), expected);
        }
    }

    #[test]
    fn a_quantity_knows_its_units_by_first_spellings() {
        let units: Vec<_> = Quantity::AngularSpeed.units().collect();
        assert_eq!(units, ["rad/s", "rpm", "krpm", "deg/s", "rev/s"]);
    }

    #[test]
    fn speeds_and_angles_follow_from_the_circle() {
        // Values of the circle itself: a revolution is 2 pi, a minute has 60 s.
        let si = |unit: &str, value: f64| Unit::parse(unit).unwrap().to_si(value);
        let near = |a: f64, b: f64| (a - b).abs() <= 4.0 * f64::EPSILON * b.abs();
        assert!(near(si("rpm", 3000.0), 314.159_265_358_979_3));
        assert!(near(si("krpm", 3.0), si("1/min", 3000.0)));
        assert!(near(si("°/s", 360.0), si("rev/s", 1.0)));
        assert!(near(si("deg", 360.0), si("rev", 1.0)));
        assert!(near(si("mm/s", 250.0), 0.25));
        assert!(near(si("degC", 20.0), 293.15));
    }

    #[test]
    fn spellings_meet_and_case_keeps_its_meaning() {
        for (a, b) in [("N·m", "N m"), ("Nm", "N*m"), ("µm", "um"), ("μs", "us"), ("RPM", "rpm")]
        {
            assert_eq!(Unit::parse(a).unwrap(), Unit::parse(b).unwrap(), "{a} and {b}");
        }
        assert_eq!(Unit::parse("MV"), None, "a megavolt is not a millivolt");
        assert_eq!(Unit::parse("furlong"), None);
        assert_ne!(Unit::parse("mN m").unwrap().quantity, Unit::parse("mN").unwrap().quantity);
    }

    #[test]
    fn units_of_other_languages_and_of_names_are_known() {
        for (text, same) in [
            ("rad_s", "rad/s"),
            ("rad_per_s", "rad/s"),
            ("rad per s", "rad/s"),
            ("m_s", "m/s"),
            ("deg_s", "deg/s"),
            ("N_m", "N m"),
            ("mNm", "mN m"),
            ("1_min", "rpm"),
            ("min-1", "rpm"),
            ("min⁻¹", "rpm"),
            ("tr/min", "rpm"),
            ("giri/min", "rpm"),
            ("vueltas/min", "rpm"),
            ("U_min", "rpm"),
            ("°C", "degC"),
            ("°", "deg"),
        ] {
            assert!(Unit::parse(text).is_some(), "{text}");
            assert_eq!(Unit::parse(text), Unit::parse(same), "{text}");
        }
        for text in ["kHz", "V/1000rpm", "counts", "Ohm", "inc", "counts/parsec", "counts/0"] {
            assert_eq!(Unit::parse(text), None, "{text}");
        }
    }

    #[test]
    fn no_spelling_stands_twice() {
        let all: Vec<&str> = TABLE.iter().flat_map(|row| row.0.iter().copied()).collect();
        for (k, text) in all.iter().enumerate() {
            assert!(!all[..k].contains(text), "`{text}` is listed twice");
        }
    }

    #[test]
    fn si_units_leave_every_bit_alone() {
        let value = Unit::parse("V").unwrap().to_si(-0.0);
        assert_eq!(value.to_bits(), (-0.0_f64).to_bits());
    }
}
