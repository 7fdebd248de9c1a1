//! Numbers and names as they are read, wherever they stand.

use drivescope_discovery::{BothUnexplained, Unexplained};
use drivescope_plant::drive::Motion;
use drivescope_scenarios::results::{FaultName, TorqueReading};

/// `tacho +5 %`.
pub(crate) fn fault(fault: &FaultName) -> String {
    format!("{} {} %", fault.kind.replace('_', " "), signed_percent(fault.size))
}

/// Per cent with its sign and as many decimals as it has, at most two: `+5`, `-12.5`.
fn signed_percent(fraction: f64) -> String {
    let rounded = (fraction * 1e4).round() / 100.0;
    format!("{rounded:+}")
}

/// A fraction in per cent.
pub(crate) fn percent(fraction: f64, decimals: usize) -> String {
    format!("{:.decimals$}", 100.0 * fraction)
}

/// Three significant digits; powers of ten where the number is far from 1.
pub(crate) fn number(value: f64) -> String {
    significant(value, 3)
}

/// An error in units of the noise: with the digits by which steps of a ladder differ.
pub(crate) fn error(value: f64) -> String {
    significant(value, 4)
}

/// Error, in units of the sensors' noise, up to which the noise floor is in reach, and that unit says
/// something to a person. Of an encoder with steps of a nanometre it says nothing.
const REACHABLE: f64 = 10.0;

/// Whether an error is told in units of the noise.
pub(crate) fn in_units_of_noise(error: f64) -> bool {
    error <= REACHABLE
}

/// What the balances leave unexplained, each under its name: an axis that moves along a line has
/// forces.
pub(crate) fn balances(
    motion: Motion,
    remainder: &BothUnexplained,
) -> [(&'static str, Option<Unexplained>); 2] {
    let driving = match motion {
        Motion::Rotary => "torque",
        Motion::Linear => "force",
    };
    [(driving, remainder.torque), ("voltage", remainder.voltage)]
}

/// The fit of an output: a percentage, or that the model overflowed.
pub(crate) fn fit_percent(fit: f64) -> String {
    if fit.is_finite() { format!("{fit:.2} %") } else { "overflow".to_owned() }
}

/// So many significant digits; powers of ten where the number is far from 1.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        // No zero has a sign.
        return (value + 0.0).to_string();
    }
    // Rounded first, so that 9.999 counts as 10.0.
    let exponent = value.abs().log10();
    let rounded = format!("{value:.*e}", digits as usize - 1);
    let power: i32 = rounded
        .split_once('e')
        .map_or(exponent as i32, |parts| parts.1.parse().unwrap_or(exponent as i32));
    if (-3..6).contains(&power) {
        let decimals = (digits - 1 - power).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        rounded
    }
}

/// A number that was given, not measured: without the zeros that would claim precision.
pub(crate) fn given(value: f64) -> String {
    let text = number(value);
    match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// An estimate with its standard error, where that is known, and its unit; `value` is in words.
pub(crate) fn estimated(value: &str, std_error: f64, unit: &str) -> String {
    let error = match std_error.is_finite() {
        true => format!(" \u{b1} {}", number(std_error)),
        false => String::new(),
    };
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    format!("{value}{error}{unit}")
}

/// A probability, short of certainty.
pub(crate) fn probability(p: f64) -> String {
    match p {
        p if p > 0.9999 => "> 0.9999".to_owned(),
        p if p < 1e-4 => "< 0.0001".to_owned(),
        p => format!("{p:.4}"),
    }
}

/// A p value; one that is zero in floating point is only known to be small.
pub(crate) fn p_value(p: f64) -> String {
    if p.is_nan() {
        "not computed".into()
    } else if p < f64::MIN_POSITIVE {
        "< 1e-300".into()
    } else {
        number(p)
    }
}

/// The same in a sentence: `p = 0.012`, `p < 1e-300`.
pub(crate) fn p_is(p: f64) -> String {
    let text = p_value(p);
    let equals = if text.starts_with('<') { "" } else { "= " };
    format!("p {equals}{text}")
}

/// What a reading of the torque fault means.
pub(crate) fn torque(reading: TorqueReading) -> &'static str {
    match reading {
        TorqueReading::Flux => "excitation flux (K_m and K_e change)",
        TorqueReading::TorqueConstant => "torque constant (K_m alone changes)",
        TorqueReading::Actuator => "amplifier (its gain changes)",
        TorqueReading::Load => "load (a share of the rated torque)",
    }
}

/// `1 run`, `2 runs`.
pub(crate) fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// The beginning of a sentence.
pub(crate) fn capital(words: &str) -> String {
    let mut chars = words.chars();
    chars.next().map_or_else(String::new, |c| c.to_uppercase().chain(chars).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_named_by_what_they_are() {
        let named =
            |kind: &str, size| fault(&FaultName { kind: kind.into(), size, label: String::new() });
        assert_eq!(named("tacho", 0.05), "tacho +5 %");
        assert_eq!(named("torque_constant", -0.125), "torque constant -12.5 %");
    }

    #[test]
    fn what_is_left_of_a_linear_axis_is_a_force() {
        let remainder =
            BothUnexplained { torque: Some(Unexplained { rms: 2.0, share: 0.1 }), voltage: None };
        assert_eq!(balances(Motion::Linear, &remainder)[0], ("force", remainder.torque));
        assert_eq!(balances(Motion::Rotary, &remainder)[0], ("torque", remainder.torque));
        assert_eq!(balances(Motion::Linear, &remainder)[1], ("voltage", None));
    }

    #[test]
    fn numbers_have_three_digits_wherever_they_lie() {
        for (value, text) in [
            (5.678_9, "5.68"),
            (9.999, "10.0"),
            (-0.0, "0"),
            (0.011_7, "0.0117"),
            (123_456.0, "123456"),
            (0.0, "0"),
            (3.14e-13, "3.14e-13"),
            (-20.94, "-20.9"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(significant(1.0, 5), "1.0000", "not 1.0000e0");
        assert_eq!(significant(8.2e-5, 5), "8.2000e-5");
        assert_eq!(p_value(0.0), "< 1e-300");
        assert_eq!((p_is(0.0), p_is(0.012)), ("p < 1e-300".into(), "p = 0.0120".into()));
        assert_eq!(given(0.001), "0.001");
        assert_eq!(given(2000.0), "2000");
        assert_eq!(given(5.0), "5");
    }
}
