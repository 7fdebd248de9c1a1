//! The names that the other parts of the program know, and the foreign names taken for them.

use crate::unit::{Quantity, Unit};

/// A signal with a meaning of its own in the program.
#[derive(Debug, PartialEq)]
pub(crate) struct Canonical {
    pub(crate) name: &'static str,
    /// What it may be measured in.
    pub(crate) quantities: &'static [Quantity],
    /// Unit that a column without one is taken to be in.
    pub(crate) bare_unit: &'static str,
    /// Whether values stay in the unit of the file (the tachometer's own).
    pub(crate) keeps_unit: bool,
}

impl Canonical {
    /// Whether the signal can be in that unit.
    pub(crate) fn accepts(&self, unit: &str) -> bool {
        Unit::parse(unit).is_some_and(|unit| self.quantities.contains(&unit.quantity))
    }
}

const fn si(
    name: &'static str,
    quantities: &'static [Quantity],
    bare_unit: &'static str,
) -> Canonical {
    Canonical { name, quantities, bare_unit, keeps_unit: false }
}

use Quantity::{
    Angle, AngularSpeed, Current, Dimensionless, Force, Length, Speed, Temperature, Time, Torque,
    Voltage,
};

/// `time` first: every recording has one.
pub(crate) const CANONICAL: &[Canonical] = &[
    si("time", &[Time], "s"),
    si("u", &[Voltage, Current, Force, Torque], "V"),
    si("i", &[Current], "A"),
    si("omega", &[AngularSpeed], "rad/s"),
    si("v", &[Speed], "m/s"),
    si("theta", &[Angle], "rad"),
    si("x", &[Length], "m"),
    si(
        "reference",
        &[AngularSpeed, Speed, Angle, Length, Voltage, Current, Force, Torque, Dimensionless],
        "1",
    ),
    si("T_l", &[Torque, Force], "N m"),
    si("C_m", &[Voltage], "V"),
    Canonical {
        name: "T",
        quantities: &[AngularSpeed, Speed, Voltage],
        bare_unit: "rpm",
        keeps_unit: true,
    },
    si("I_m", &[Current], "A"),
    si("temperature", &[Temperature], "K"),
];

/// Foreign names (as [`folded`] writes them), and what they may stand for: the first that accepts
/// the column's unit is taken, or the first of all where the column has none.
const FOREIGN: &[(&[&str], &[&str])] = &[
    (&["t", "time", "timestamp", "times", "tsec", "seconds", "zeit", "clock"], &["time"]),
    (&["u", "voltage", "vm", "um", "ua", "va", "vir", "motorvoltage", "armaturevoltage"], &["u"]),
    (&["uin", "vin", "input", "control", "controlvoltage"], &["u"]),
    (&["i", "current", "im", "ia", "motorcurrent", "armaturecurrent"], &["i"]),
    (&["omega", "w", "speed", "angularvelocity", "angularspeed", "wm", "omegam"], &["omega", "v"]),
    (&["motorspeed", "rotorspeed", "shaftspeed", "n", "rpm", "drehzahl"], &["omega", "v"]),
    (&["velocity", "vel", "linearvelocity"], &["v", "omega"]),
    (&["theta", "angle", "phi", "rotorangle", "shaftangle", "encoder"], &["theta", "x"]),
    (&["x", "pos", "position", "qm", "displacement", "q"], &["x", "theta"]),
    (&["reference", "ref", "setpoint", "sp", "target", "command", "cmd", "qg"], &["reference"]),
    (&["speedref", "refspeed", "omegaref", "speedsetpoint", "posref"], &["reference"]),
    (&["tl", "loadtorque", "tload", "load", "torqueload"], &["T_l"]),
    (&["temperature", "temp", "windingtemperature", "motortemperature"], &["temperature"]),
    (&["tacho", "tachometer", "tach"], &["T"]),
    // One letter for two things: the unit, and where there is none the case, tells.
    (&["v"], &["u", "v"]),
];

/// The canonical signal of exactly that name.
pub(crate) fn exact(name: &str) -> Option<&'static Canonical> {
    CANONICAL.iter().find(|canonical| canonical.name == name)
}

/// The canonical signal that a foreign name in that unit is likely to be.
pub(crate) fn guess(name: &str, unit: Option<&str>) -> Option<&'static Canonical> {
    if name == "T" {
        // Exactly `T` is the tachometer, unless its unit says that it is a temperature.
        return exact("temperature").filter(|it| unit.is_some_and(|unit| it.accepts(unit)));
    }
    let folded = folded(name);
    let row = FOREIGN.iter().find(|row| row.0.contains(&folded.as_str()))?;
    row.1
        .iter()
        .filter_map(|name| exact(name))
        .find(|canonical| unit.is_none_or(|unit| canonical.accepts(unit)))
}

/// The unit that a foreign name is itself (`rpm`), if it is one.
pub(crate) fn unit_in_name(name: &str) -> Option<&'static str> {
    ["rpm", "n", "drehzahl"].contains(&folded(name).as_str()).then_some("rpm")
}

/// Lower case without blanks, underscores, hyphens and dots.
fn folded(name: &str) -> String {
    name.chars().filter(|c| !" _-.".contains(*c)).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bare_unit_fits_its_signal() {
        for canonical in CANONICAL {
            assert!(canonical.accepts(canonical.bare_unit), "{}", canonical.name);
        }
    }

    #[test]
    fn every_foreign_name_is_folded_listed_once_and_leads_somewhere() {
        let mut seen: Vec<&str> = Vec::new();
        for (names, targets) in FOREIGN {
            for name in *names {
                assert_eq!(folded(name), **name);
                assert!(!seen.contains(name), "`{name}` is listed twice");
                seen.push(name);
            }
            for target in *targets {
                assert!(exact(target).is_some(), "`{target}` is no canonical signal");
            }
        }
    }

    #[test]
    fn the_unit_tells_what_a_word_means() {
        let name = |name, unit| guess(name, unit).map(|canonical| canonical.name);
        assert_eq!(name("Speed", None), Some("omega"));
        assert_eq!(name("Speed", Some("mm/s")), Some("v"));
        assert_eq!(name("position", Some("deg")), Some("theta"));
        assert_eq!(name("Position", None), Some("x"));
        assert_eq!(name("V", None), Some("u"));
        assert_eq!(name("T", Some("degC")), Some("temperature"));
        assert_eq!(name("t", None), Some("time"));
        assert_eq!(name("Speed", Some("V")), None);
        assert_eq!(name("vibration", None), None);
    }
}
