//! A unit in SI base units, as the FMI standard has it: powers, a factor and an offset.

use crate::unit::Unit;

/// Powers of the SI base units (and rad), factor and offset to them:
/// `SI value = factor * value + offset` (FMI 2.0.4 section 2.2.2, FMI 3.0.2 section 2.4.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseUnit {
    /// Power of each of [`BaseUnit::NAMES`].
    pub powers: [i32; 8],
    /// Base units in one unit.
    pub factor: f64,
    /// Base units at zero of the unit (273.15 for degC).
    pub offset: f64,
}

impl BaseUnit {
    /// Names of the base units in the order of [`BaseUnit::powers`].
    pub const NAMES: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];

    /// The unit of a number.
    pub const ONE: Self = Self { powers: [0; 8], factor: 1.0, offset: 0.0 };

    /// Times another unit to that power; offsets do not multiply.
    pub(crate) fn times(mut self, other: Self, power: i32) -> Self {
        for (own, others) in self.powers.iter_mut().zip(other.powers) {
            *own += others * power;
        }
        self.factor *= other.factor.powi(power);
        self
    }

    /// How values in this unit become values in the other; `None` if they measure different things.
    pub fn to(self, other: Self) -> Option<Conversion> {
        (self.powers == other.powers).then(|| Conversion {
            factor: self.factor / other.factor,
            offset: (self.offset - other.offset) / other.factor,
        })
    }
}

impl From<Unit> for BaseUnit {
    fn from(unit: Unit) -> Self {
        let factor = unit.numerator / unit.denominator;
        Self { powers: unit.quantity.powers(), factor, offset: unit.offset }
    }
}

/// An affine conversion of values: `factor * value + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    pub factor: f64,
    /// Offset, in the unit of the result.
    pub offset: f64,
}

impl Conversion {
    /// Leaves values as they are.
    pub const IDENTITY: Conversion = Conversion { factor: 1.0, offset: 0.0 };

    /// Converts one value.
    pub fn apply(self, value: f64) -> f64 {
        self.factor * value + self.offset
    }

    /// This conversion, then another.
    pub fn then(self, next: Conversion) -> Conversion {
        Conversion { factor: next.factor * self.factor, offset: next.apply(self.offset) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::powers::{K, powers};

    #[test]
    fn a_factor_is_that_of_the_table() {
        for (unit, factor) in [("rpm", std::f64::consts::PI / 30.0), ("ms", 1e-3), ("degC", 1.0)] {
            let unit = Unit::parse(unit).expect("a known unit");
            assert_eq!(BaseUnit::from(unit).factor, factor);
        }
    }

    #[test]
    fn units_of_one_quantity_convert_both_ways() {
        let kelvin = powers(&[(K, 1)]);
        let celsius = BaseUnit { powers: kelvin, factor: 1.0, offset: 273.15 };
        let fahrenheit =
            BaseUnit { powers: kelvin, factor: 5.0 / 9.0, offset: 273.15 - 160.0 / 9.0 };
        let there = celsius.to(fahrenheit).expect("both are temperatures");
        // Rounding of two additions of about 500.
        const ROUNDING: f64 = 1e-12;
        assert!((there.apply(100.0) - 212.0).abs() < 212.0 * ROUNDING);
        let back = fahrenheit.to(celsius).expect("both are temperatures");
        assert!((there.then(back).apply(36.6) - 36.6).abs() < 500.0 * ROUNDING);
        assert_eq!(celsius.to(BaseUnit::ONE), None);
    }
}
