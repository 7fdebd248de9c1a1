//! Units as products of symbols: `N m/A`, `kg m^2`, `V s/rad`.
//!
//! Symbols are joined by space, `.` or `*`; `/` divides by the one symbol after it; `^2` or a
//! trailing digit is a power.

use crate::base::BaseUnit;
use crate::powers::{A, KG, M, S, powers};
use crate::table::{TABLE, listed};

/// A unit that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnitError {
    /// A symbol is not known.
    #[error("unit `{unit}`: symbol `{symbol}` is not known; use SI symbols such as `N m/A`")]
    Symbol { unit: String, symbol: String },
    /// A power is not a small integer.
    #[error("unit `{unit}`: `{power}` is not a power between -9 and 9")]
    Power {
        unit: String,
        /// The part read as a power.
        power: String,
    },
    /// A unit with an offset was multiplied or raised to a power.
    #[error("unit `{unit}`: degC has an offset and cannot be combined; use K")]
    Offset { unit: String },
}

impl BaseUnit {
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
        Ok(base)
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

/// The symbols that drives, their sensors and their temperatures need: of the table, what is spelt
/// so first; others (`C`, `tr`) would mean something else in a product.
fn known(symbol: &str) -> Option<BaseUnit> {
    let of = |factor: f64, named: &[(usize, i32)]| {
        Some(BaseUnit { powers: powers(named), factor, offset: 0.0 })
    };
    match symbol {
        "kg" => of(1.0, &[(KG, 1)]),
        "g" => of(1e-3, &[(KG, 1)]),
        "Hz" => of(1.0, &[(S, -1)]),
        "Nm" | "J" | "Ws" => of(1.0, &[(KG, 1), (M, 2), (S, -2)]),
        "W" => of(1.0, &[(KG, 1), (M, 2), (S, -3)]),
        "ohm" | "Ohm" => of(1.0, &[(KG, 1), (M, 2), (S, -3), (A, -2)]),
        "H" => of(1.0, &[(KG, 1), (M, 2), (S, -2), (A, -2)]),
        "mH" => of(1e-3, &[(KG, 1), (M, 2), (S, -2), (A, -2)]),
        "Wb" => of(1.0, &[(KG, 1), (M, 2), (S, -2), (A, -1)]),
        _ => {
            let spelt = TABLE.iter().any(|row| row.0[0] == symbol);
            listed(symbol).filter(|_| spelt).map(BaseUnit::from)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

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
            let base = BaseUnit::parse(name).unwrap();
            assert_eq!(base, BaseUnit { powers, factor, offset: 0.0 }, "{name}");
        }
        assert_eq!(BaseUnit::parse("degC").unwrap().offset, 273.15);
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let symbol = |unit: &str, symbol: &str| UnitError::Symbol {
            unit: unit.to_owned(),
            symbol: symbol.to_owned(),
        };
        assert_eq!(BaseUnit::parse("N furlong"), Err(symbol("N furlong", "furlong")));
        assert_eq!(BaseUnit::parse("N/"), Err(symbol("N/", "/")));
        assert!(matches!(BaseUnit::parse("m^x"), Err(UnitError::Power { .. })));
        assert!(matches!(BaseUnit::parse("m^0"), Err(UnitError::Power { .. })));
        assert!(matches!(BaseUnit::parse("J/degC"), Err(UnitError::Offset { .. })));
    }
}
