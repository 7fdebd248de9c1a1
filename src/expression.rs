//! A signal over time as it is typed: `200 + 20 * sin(2 * pi * t)`, with a unit as in a column
//! header where it is not SI: `2000 [rpm]`.

use drivescope_plant::effects::custom::{Expression, LawError};
use drivescope_recording::{Quantity, Unit, rounded};
use miette::{Diagnostic, NamedSource, SourceSpan};
use thiserror::Error;

use crate::failure::visible;

/// A typed signal.
#[derive(Debug, Clone)]
pub(crate) struct SignalOverTime {
    expression: Expression,
    unit: Option<Unit>,
    /// As it was typed.
    pub(crate) text: String,
}

/// Why a typed signal cannot be used.
#[derive(Debug, Error, Diagnostic)]
enum Wrong {
    #[error("{option}: {error}")]
    #[diagnostic(help("it is a law in `t` [s], such as `200 + 20 * sin(2 * pi * t)`"))]
    Law {
        option: &'static str,
        error: LawError,
        #[source_code]
        text: NamedSource<String>,
        #[label("here")]
        at: Option<SourceSpan>,
    },
    #[error("{option}: `{unit}` is no unit of it; leave it out for {si}")]
    Unit { option: &'static str, unit: String, si: &'static str },
    #[error("{option}: `{text}` is {value} at t = {} s", rounded(*time))]
    #[diagnostic(help("it must be finite over the whole run"))]
    NotFinite { option: &'static str, text: String, value: f64, time: f64 },
}

impl SignalOverTime {
    /// Parses what was given to that option, which stands for that quantity.
    ///
    /// # Errors
    /// The place in the text, or a unit of another quantity.
    pub(crate) fn parse(
        option: &'static str,
        text: &str,
        quantity: Quantity,
    ) -> miette::Result<Self> {
        let trimmed = text.trim_end();
        let bracketed = trimmed.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
        let (law, unit) = match bracketed {
            None => (text, None),
            Some((law, name)) => {
                let unit = Unit::parse(name.trim()).filter(|unit| unit.quantity == quantity);
                let wrong =
                    || Wrong::Unit { option, unit: name.trim().to_owned(), si: quantity.si() };
                (law, Some(unit.ok_or_else(wrong)?))
            }
        };
        let expression = Expression::parse(law).map_err(|error| Wrong::Law {
            option,
            at: visible(text, error.at()..error.at()),
            text: NamedSource::new(option, text.to_owned()),
            error,
        })?;
        Ok(Self { expression, unit, text: text.trim().to_owned() })
    }

    /// The values at `t0 + k period` for `count` samples, SI.
    ///
    /// # Errors
    /// A value that is not finite, with its time.
    pub(crate) fn sampled(
        &self,
        option: &'static str,
        period_s: f64,
        count: usize,
    ) -> miette::Result<Vec<f64>> {
        let value = |k: usize| {
            let time = k as f64 * period_s;
            let value = self.expression.at(time);
            if !value.is_finite() {
                return Err(
                    Wrong::NotFinite { option, text: self.text.clone(), value, time }.into()
                );
            }
            Ok(self.unit.map_or(value, |unit| unit.to_si(value)))
        };
        (0..count).map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> miette::Result<SignalOverTime> {
        SignalOverTime::parse("--reference", text, Quantity::AngularSpeed)
    }

    #[test]
    fn units_stand_in_brackets() {
        let speed = parse("1000 + 2000 * t [rpm]").expect("it is right");
        let values = speed.sampled("--reference", 0.5, 3).expect("it is finite");
        let rpm = std::f64::consts::PI / 30.0;
        // A product of three numbers, each rounded once.
        const ROUNDING: f64 = 1e-12;
        for (value, expected) in values.iter().zip([1000.0, 2000.0, 3000.0]) {
            assert!((value - expected * rpm).abs() < ROUNDING, "{value}");
        }
        assert_eq!(parse("7").and_then(|law| law.sampled("", 1.0, 1)).expect("it is right"), [7.0]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, said) in
            [("1 +", "--reference: expected"), ("3 [V]", "`V`"), ("omega", "`omega`")]
        {
            let error = parse(text).expect_err("it is wrong").to_string();
            assert!(error.contains(said), "{error}");
        }
        let error = parse("1 / (t - 1)").and_then(|law| law.sampled("--reference", 0.5, 4));
        let error = error.expect_err("it has a pole").to_string();
        assert!(error.contains("t = 1 s"), "{error}");
    }
}
