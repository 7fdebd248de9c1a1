//! The names that the other parts of the program know.

/// A signal with a meaning of its own in the program.
#[derive(Debug, PartialEq)]
pub(crate) struct Canonical {
    pub(crate) name: &'static str,
    /// What it is, for people.
    pub(crate) words: &'static str,
    /// What it may be measured in.
    pub(crate) quantities: &'static [Quantity],
    /// Unit that a column without one is taken to be in.
    pub(crate) bare_unit: &'static str,
    /// Quantities whose values stay in the unit of the file (a sensor's own).
    pub(crate) kept: &'static [Quantity],
}

impl Canonical {
    /// Whether the signal can be in that unit.
    pub(crate) fn accepts(&self, unit: &str) -> bool {
        Unit::parse(unit).is_some_and(|unit| self.quantities.contains(&unit.quantity))
    }
}

const fn si(
    name: &'static str,
    words: &'static str,
    quantities: &'static [Quantity],
    bare_unit: &'static str,
) -> Canonical {
    Canonical { name, words, quantities, bare_unit, kept: &[] }
}

use Quantity::{
    Angle, AngularSpeed, Current, Dimensionless, Force, Length, Speed, Temperature, Time, Torque,
    Voltage,
};
use drivescope_units::{Quantity, Unit};

/// `time` first: every recording has one.
pub(crate) const CANONICAL: &[Canonical] = &[
    si("time", "time", &[Time], "s"),
    si("u", "armature voltage or drive command", &[Voltage, Current, Force, Torque], "V"),
    si("i", "armature current", &[Current], "A"),
    si("omega", "speed of the shaft", &[AngularSpeed], "rad/s"),
    si("v", "speed of the carriage", &[Speed], "m/s"),
    si("theta", "position of the shaft", &[Angle], "rad"),
    si("x", "position of the carriage", &[Length], "m"),
    si(
        "reference",
        "set point",
        &[AngularSpeed, Speed, Angle, Length, Voltage, Current, Force, Torque, Dimensionless],
        "1",
    ),
    si("torque", "motor torque or force", &[Torque, Force], "N m"),
    si("T_l", "load torque or force", &[Torque, Force], "N m"),
    si("omega_load", "speed of the load side", &[AngularSpeed], "rad/s"),
    si("v_load", "speed of the load-side carriage", &[Speed], "m/s"),
    si("theta_load", "position of the load side", &[Angle], "rad"),
    si("x_load", "position of the load-side carriage", &[Length], "m"),
    // A duty of a converter has no unit that could be converted.
    Canonical {
        name: "C_m",
        words: "control signal",
        quantities: &[Voltage, Dimensionless],
        bare_unit: "V",
        kept: &[Dimensionless],
    },
    Canonical {
        name: "T",
        words: "speed of the tachometer",
        quantities: &[AngularSpeed, Speed, Voltage],
        bare_unit: "rpm",
        kept: &[AngularSpeed, Speed, Voltage],
    },
    si("I_m", "measured current of the controller", &[Current], "A"),
    si("temperature", "winding temperature", &[Temperature], "K"),
    si("segment", "number of the run", &[Dimensionless], "1"),
];

/// The canonical signal of exactly that name.
pub(crate) fn exact(name: &str) -> Option<&'static Canonical> {
    CANONICAL.iter().find(|canonical| canonical.name == name)
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
}
