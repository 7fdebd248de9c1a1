//! Units as FMI wants them: powers of the SI base units, a factor and an offset.
//!
//! `BaseUnit_value = factor * Unit_value + offset` (FMI 2.0.4 section 2.2.2). A unit is written
//! as its name is read, `N m/A`, `kg m^2`, `V s/rad`: symbols joined by space, `.` or `*`; `/`
//! divides by the one symbol after it; `^2` or a trailing digit is a power.

use std::f64::consts::PI;

/// A named unit and its meaning in SI base units.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// The name as given.
    pub name: String,
    /// What one of it is.
    pub base: BaseUnit,
}

/// Powers of the SI base units (and rad), factor and offset to them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseUnit {
    /// Power of each of [`BaseUnit::NAMES`].
    pub powers: [i32; 8],
    /// Base units in one unit.
    pub factor: f64,
    /// Base units at zero of the unit (273.15 for degC).
    pub offset: f64,
}

/// A unit that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnitError {
    /// A symbol is not known.
    #[error("unit `{unit}`: symbol `{symbol}` is not known; use SI symbols such as `N m/A`")]
    Symbol {
        /// The whole unit.
        unit: String,
        /// The unknown part.
        symbol: String,
    },
    /// A power is not a small integer.
    #[error("unit `{unit}`: `{power}` is not a power between -9 and 9")]
    Power {
        /// The whole unit.
        unit: String,
        /// The part read as a power.
        power: String,
    },
    /// A unit with an offset was multiplied or raised to a power.
    #[error("unit `{unit}`: degC has an offset and cannot be combined; use K")]
    Offset {
        /// The whole unit.
        unit: String,
    },
}

impl BaseUnit {
    /// Names of the base units in the order of [`BaseUnit::powers`].
    pub const NAMES: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];

    const ONE: Self = Self { powers: [0; 8], factor: 1.0, offset: 0.0 };

    fn times(mut self, other: Self, power: i32) -> Self {
        for (own, others) in self.powers.iter_mut().zip(other.powers) {
            *own += others * power;
        }
        self.factor *= other.factor.powi(power);
        self
    }
}

impl Unit {
    /// Reads a unit such as `N m s/rad`.
    ///
    /// # Errors
    ///
    /// The symbol or power that cannot be read.
    pub fn parse(name: &str) -> Result<Self, UnitError> {
        let unit = || name.to_owned();
        let spaced = name.replace(['.', '*', '·'], " ").replace('/', " / ");
        let mut base = BaseUnit::ONE;
        let mut sign = 1;
        let mut words = spaced.split_whitespace().peekable();
        let alone = words.clone().count() == 1;
        while let Some(word) = words.next() {
            if word == "/" && sign == 1 && words.peek().is_some() {
                sign = -1;
                continue;
            }
            let (symbol, power) = split_power(word)
                .map_err(|power| UnitError::Power { unit: unit(), power: power.to_owned() })?;
            let factor = known(symbol)
                .ok_or_else(|| UnitError::Symbol { unit: unit(), symbol: symbol.to_owned() })?;
            if factor.offset != 0.0 {
                if !alone || power != 1 {
                    return Err(UnitError::Offset { unit: unit() });
                }
                base.offset = factor.offset;
            }
            base = base.times(factor, sign * power);
            sign = 1;
        }
        Ok(Self { name: unit(), base })
    }
}

/// `m^2`, `m2`, `s^-1` into symbol and power; the unreadable power on failure.
fn split_power(word: &str) -> Result<(&str, i32), &str> {
    let at = word.find(['^', '-', '²']).or_else(|| {
        let digits = word.find(|c: char| c.is_ascii_digit())?;
        (digits > 0).then_some(digits)
    });
    let Some(at) = at else { return Ok((word, 1)) };
    let (symbol, power) = word.split_at(at);
    match power.trim_start_matches('^') {
        "²" => Ok((symbol, 2)),
        text => match text.parse::<i32>() {
            Ok(power) if (1..=9).contains(&power.abs()) => Ok((symbol, power)),
            _ => Err(text),
        },
    }
}

/// The symbols that drives, their sensors and their temperatures need.
fn known(symbol: &str) -> Option<BaseUnit> {
    let unit = |factor: f64, powers: &[(usize, i32)]| {
        let mut base = BaseUnit { factor, ..BaseUnit::ONE };
        for (index, power) in powers {
            base.powers[*index] = *power;
        }
        Some(base)
    };
    const KG: usize = 0;
    const M: usize = 1;
    const S: usize = 2;
    const A: usize = 3;
    const K: usize = 4;
    const RAD: usize = 7;
    match symbol {
        "1" => unit(1.0, &[]),
        "%" => unit(0.01, &[]),
        "kg" => unit(1.0, &[(KG, 1)]),
        "g" => unit(1e-3, &[(KG, 1)]),
        "m" => unit(1.0, &[(M, 1)]),
        "mm" => unit(1e-3, &[(M, 1)]),
        "s" => unit(1.0, &[(S, 1)]),
        "ms" => unit(1e-3, &[(S, 1)]),
        "min" => unit(60.0, &[(S, 1)]),
        "Hz" => unit(1.0, &[(S, -1)]),
        "A" => unit(1.0, &[(A, 1)]),
        "mA" => unit(1e-3, &[(A, 1)]),
        "K" => unit(1.0, &[(K, 1)]),
        "degC" => Some(BaseUnit { offset: 273.15, ..unit(1.0, &[(K, 1)])? }),
        "rad" => unit(1.0, &[(RAD, 1)]),
        "deg" => unit(PI / 180.0, &[(RAD, 1)]),
        "rev" => unit(2.0 * PI, &[(RAD, 1)]),
        "rpm" => unit(PI / 30.0, &[(RAD, 1), (S, -1)]),
        "N" => unit(1.0, &[(KG, 1), (M, 1), (S, -2)]),
        "Nm" => unit(1.0, &[(KG, 1), (M, 2), (S, -2)]),
        "J" | "Ws" => unit(1.0, &[(KG, 1), (M, 2), (S, -2)]),
        "W" => unit(1.0, &[(KG, 1), (M, 2), (S, -3)]),
        "V" => unit(1.0, &[(KG, 1), (M, 2), (S, -3), (A, -1)]),
        "mV" => unit(1e-3, &[(KG, 1), (M, 2), (S, -3), (A, -1)]),
        "ohm" | "Ohm" => unit(1.0, &[(KG, 1), (M, 2), (S, -3), (A, -2)]),
        "H" => unit(1.0, &[(KG, 1), (M, 2), (S, -2), (A, -2)]),
        "mH" => unit(1e-3, &[(KG, 1), (M, 2), (S, -2), (A, -2)]),
        "Wb" => unit(1.0, &[(KG, 1), (M, 2), (S, -2), (A, -1)]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_a_drive_are_powers_of_base_units() {
        let cases = [
            ("rad/s", [0, 0, -1, 0, 0, 0, 0, 1], 1.0),
            ("rpm", [0, 0, -1, 0, 0, 0, 0, 1], PI / 30.0),
            ("N m", [1, 2, -2, 0, 0, 0, 0, 0], 1.0),
            ("N.m/A", [1, 2, -2, -1, 0, 0, 0, 0], 1.0),
            ("kg m^2", [1, 2, 0, 0, 0, 0, 0, 0], 1.0),
            ("kg.m2", [1, 2, 0, 0, 0, 0, 0, 0], 1.0),
            ("V s/rad", [1, 2, -2, -1, 0, 0, 0, -1], 1.0),
            ("N m s^2/rad^2", [1, 2, 0, 0, 0, 0, 0, -2], 1.0),
            ("mA", [0, 0, 0, 1, 0, 0, 0, 0], 1e-3),
            ("1/K", [0, 0, 0, 0, -1, 0, 0, 0], 1.0),
            ("s^-1", [0, 0, -1, 0, 0, 0, 0, 0], 1.0),
            ("1", [0; 8], 1.0),
        ];
        for (name, powers, factor) in cases {
            let base = Unit::parse(name).unwrap().base;
            assert_eq!(base, BaseUnit { powers, factor, offset: 0.0 }, "{name}");
        }
        assert_eq!(Unit::parse("degC").unwrap().base.offset, 273.15);
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let symbol = |unit: &str, symbol: &str| UnitError::Symbol {
            unit: unit.to_owned(),
            symbol: symbol.to_owned(),
        };
        assert_eq!(Unit::parse("N furlong"), Err(symbol("N furlong", "furlong")));
        assert_eq!(Unit::parse("N/"), Err(symbol("N/", "/")));
        assert!(matches!(Unit::parse("m^x"), Err(UnitError::Power { .. })));
        assert!(matches!(Unit::parse("m^0"), Err(UnitError::Power { .. })));
        assert!(matches!(Unit::parse("J/degC"), Err(UnitError::Offset { .. })));
    }
}
