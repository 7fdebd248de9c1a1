//! A unit that a column's header may carry, and its way to SI.
//!
//! `SI value = value * numerator / denominator + offset`. Factors are kept as a fraction, because
//! `1 / 1000` is rounded once and `* 0.001` twice: 1 ms becomes exactly the number that `0.001`
//! is read as.

use std::f64::consts::PI;

use crate::quantity::Quantity;

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

    /// The value in the quantity's SI unit.
    pub fn to_si(self, value: f64) -> f64 {
        // The identity leaves every bit alone, the sign of a zero too.
        if self.is_si() { value } else { value * self.numerator / self.denominator + self.offset }
    }

    /// The value of one given in the quantity's SI unit.
    pub fn from_si(self, value: f64) -> f64 {
        if self.is_si() { value } else { (value - self.offset) * self.denominator / self.numerator }
    }

    /// Whether the unit is the SI unit itself.
    pub fn is_si(self) -> bool {
        self.numerator == self.denominator && self.offset == 0.0
    }
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
    fn si_units_leave_every_bit_alone() {
        let value = Unit::parse("V").unwrap().to_si(-0.0);
        assert_eq!(value.to_bits(), (-0.0_f64).to_bits());
    }
}
