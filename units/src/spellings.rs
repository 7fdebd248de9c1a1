//! How units are written: looked up by a text, named by their first spellings.

use crate::counts::counted;
use crate::quantity::Quantity;
use crate::table::{TABLE, listed, normalized};
use crate::unit::Unit;

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
}

impl Quantity {
    /// The units that a column of this quantity may be in, as they are spelt first.
    pub fn units(self) -> impl Iterator<Item = &'static str> {
        TABLE.iter().filter(move |row| row.1 == self).map(|row| row.0[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_quantity_knows_its_units_by_first_spellings() {
        let units: Vec<_> = Quantity::AngularSpeed.units().collect();
        assert_eq!(units, ["rad/s", "rpm", "krpm", "deg/s", "rev/s"]);
    }
}
