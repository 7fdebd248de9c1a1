//! Units as FMI defines them: a name, and how it is expressed in SI base units,
//! `value_SI = factor * value + offset` (FMI 2.0 section 2.2.2, FMI 3.0 section 2.4.3).

use drivescope_recording::{Quantity, Unit as Known};

/// Exponents of kg, m, s, A, K, mol, cd, rad, in this order, with the conversion to them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseUnit {
    /// Exponents of kg, m, s, A, K, mol, cd, rad.
    pub exponents: [i32; 8],
    /// Factor of the conversion to SI base units.
    pub factor: f64,
    /// Offset of the conversion to SI base units.
    pub offset: f64,
}

impl BaseUnit {
    /// What a unit of that name is where nobody defines it: the units of measured signals.
    pub fn known(name: &str) -> Option<BaseUnit> {
        let unit = Known::parse(name)?;
        let exponents = match unit.quantity {
            Quantity::Time => [0, 0, 1, 0, 0, 0, 0, 0],
            Quantity::Voltage => [1, 2, -3, -1, 0, 0, 0, 0],
            Quantity::Current => [0, 0, 0, 1, 0, 0, 0, 0],
            Quantity::AngularSpeed => [0, 0, -1, 0, 0, 0, 0, 1],
            Quantity::Speed => [0, 1, -1, 0, 0, 0, 0, 0],
            Quantity::Angle => [0, 0, 0, 0, 0, 0, 0, 1],
            Quantity::Length => [0, 1, 0, 0, 0, 0, 0, 0],
            Quantity::Torque => [1, 2, -2, 0, 0, 0, 0, 0],
            Quantity::Force => [1, 1, -2, 0, 0, 0, 0, 0],
            Quantity::Temperature => [0, 0, 0, 0, 1, 0, 0, 0],
            Quantity::Dimensionless => [0; 8],
        };
        let offset = unit.to_si(0.0);
        Some(BaseUnit { exponents, factor: unit.to_si(1.0) - offset, offset })
    }
}

/// A unit that an FMU defines.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// The name by which variables refer to it.
    pub name: String,
    /// What it is in SI base units, if stated.
    pub base: Option<BaseUnit>,
}

/// An affine conversion of values: `factor * value + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Factor.
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

/// How values in `from` become values in `to`; `None` if they measure different things. Units of the
/// same name are the same; where one side states no unit there is nothing to check. A unit that says
/// nothing of SI is taken for the known one of its name, if there is one.
pub fn convert(from: Option<&Unit>, to: Option<&Unit>) -> Option<Conversion> {
    let (Some(from), Some(to)) = (from, to) else { return Some(Conversion::IDENTITY) };
    if from.name == to.name {
        return Some(Conversion::IDENTITY);
    }
    let base = |unit: &Unit| unit.base.or_else(|| BaseUnit::known(&unit.name));
    let (from, to) = (base(from)?, base(to)?);
    (from.exponents == to.exponents).then(|| Conversion {
        factor: from.factor / to.factor,
        offset: (from.offset - to.offset) / to.factor,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(name: &str, exponents: [i32; 8], factor: f64, offset: f64) -> Unit {
        Unit { name: name.to_owned(), base: Some(BaseUnit { exponents, factor, offset }) }
    }

    #[test]
    fn units_of_one_quantity_convert_both_ways() {
        let kelvin = [0, 0, 0, 0, 1, 0, 0, 0];
        let celsius = unit("degC", kelvin, 1.0, 273.15);
        let fahrenheit = unit("degF", kelvin, 5.0 / 9.0, 273.15 - 160.0 / 9.0);
        let there = convert(Some(&celsius), Some(&fahrenheit)).unwrap();
        // Rounding of two additions of about 500.
        const ROUNDING: f64 = 1e-12;
        assert!((there.apply(100.0) - 212.0).abs() < 212.0 * ROUNDING);
        let back = convert(Some(&fahrenheit), Some(&celsius)).unwrap();
        assert!((there.then(back).apply(36.6) - 36.6).abs() < 500.0 * ROUNDING);
    }

    #[test]
    fn a_unit_without_a_definition_is_the_known_one_of_its_name() {
        let bare = |name: &str| Unit { name: name.to_owned(), base: None };
        let speed = unit("rad/s", [0, 0, -1, 0, 0, 0, 0, 1], 1.0, 0.0);
        let there = convert(Some(&bare("rpm")), Some(&speed)).unwrap();
        assert!((there.apply(30.0) - std::f64::consts::PI).abs() < 1e-12);
        let kelvin = unit("K", [0, 0, 0, 0, 1, 0, 0, 0], 1.0, 0.0);
        assert!(
            (convert(Some(&bare("degC")), Some(&kelvin)).unwrap().apply(1.0) - 274.15).abs() < 1e-9
        );
        assert_eq!(convert(Some(&bare("A")), Some(&speed)), None);
    }

    #[test]
    fn units_of_different_quantities_do_not_convert() {
        let speed = unit("rad/s", [0, 0, -1, 0, 0, 0, 0, 1], 1.0, 0.0);
        let current = unit("A", [0, 0, 0, 1, 0, 0, 0, 0], 1.0, 0.0);
        let unknown = Unit { name: "thing".to_owned(), base: None };
        assert_eq!(convert(Some(&speed), Some(&current)), None);
        assert_eq!(convert(Some(&speed), Some(&unknown)), None);
        assert_eq!(convert(Some(&unknown), Some(&unknown)), Some(Conversion::IDENTITY));
        assert_eq!(convert(Some(&speed), None), Some(Conversion::IDENTITY));
    }
}
