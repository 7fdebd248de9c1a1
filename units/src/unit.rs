//! A unit that a column's header may carry, and its way to SI.
//!
//! `SI value = value * numerator / denominator + offset`. Factors are kept as a fraction, because
//! `1 / 1000` is rounded once and `* 0.001` twice: 1 ms becomes exactly the number that `0.001`
//! is read as.

use std::f64::consts::PI;

use crate::counts::counted;
use crate::quantity::Quantity;
use crate::table::TABLE;

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
    /// Revolutions a minute.
    pub const RPM: Unit =
        Unit { quantity: Quantity::AngularSpeed, numerator: PI, denominator: 30.0, offset: 0.0 };

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

    /// The value of one given in the quantity's SI unit.
    pub fn from_si(self, value: f64) -> f64 {
        if self.is_si() { value } else { (value - self.offset) * self.denominator / self.numerator }
    }

    /// The first spellings of the units of those quantities, for a sentence.
    pub fn spelt(quantities: &[Quantity]) -> String {
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

    /// Whether the unit is the SI unit itself.
    pub fn is_si(self) -> bool {
        self.numerator == self.denominator && self.offset == 0.0
    }
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
    fn speeds_and_angles_follow_from_the_circle() {
        // Values of the circle itself: a revolution is 2 pi, a minute has 60 s.
        let si = |unit: &str, value: f64| Unit::parse(unit).unwrap().to_si(value);
        let near = |a: f64, b: f64| (a - b).abs() <= 4.0 * f64::EPSILON * b.abs();
        assert!(near(si("rpm", 3000.0), 314.159_265_358_979_3));
        assert!(near(si("krpm", 3.0), si("1/min", 3000.0)));
        assert_eq!(Unit::parse("rpm"), Some(Unit::RPM));
        assert!(near(Unit::RPM.from_si(314.159_265_358_979_3), 3000.0));
        assert!((Unit::parse("degC").unwrap().from_si(293.15) - 20.0).abs() < 1e-12);
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
    fn si_units_leave_every_bit_alone() {
        let value = Unit::parse("V").unwrap().to_si(-0.0);
        assert_eq!(value.to_bits(), (-0.0_f64).to_bits());
    }
}
