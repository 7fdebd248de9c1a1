//! The unit of a time column that does not say it, from its magnitude and its steps.

use crate::error::digits;
use crate::header::Column;

/// Seconds from 1970 to 1995: no recording on a computer is older. Smaller stamps count from
/// another moment.
pub(crate) const LEAST_EPOCH: f64 = 8e8;
/// Seconds from 1970 to 2099.
const LARGEST_EPOCH: f64 = 4.1e9;
/// Stamps of whole seconds this far apart see no drive: then the number counts microseconds.
const SLOWEST_EPOCH: f64 = 2.0;
/// A median step from here on is not in seconds, ...
const SECONDS_BELOW: f64 = 0.5;
/// ... from here on not in milliseconds, ...
const MILLISECONDS_BELOW: f64 = 500.0;
/// ... and from here on not in microseconds.
const MICROSECONDS_BELOW: f64 = 5e5;

/// Gives a time column without a unit the one that its values are likely to be in, lets time
/// since 1970 begin at its first row, and says so; `None` where nothing had to be guessed.
pub(crate) fn settle(column: &mut Column, time: &mut [f64]) -> Option<String> {
    if column.note.given_unit.is_some() {
        return None;
    }
    let first = time.iter().copied().find(|value| value.is_finite())?;
    let step = median_step(time)?;
    let name = column.note.column.clone();
    if let Some(unit) = since_1970(first, step) {
        time.iter_mut().for_each(|value| *value -= first);
        column.take_unit(unit);
        return Some(epoch(&name, unit));
    }
    let unit = by_step(step)?;
    column.take_unit(unit);
    Some(guessed(&name, unit, step))
}

/// The header of a column whose stamps were read as differences from the first (given in
/// billionths), with a unit, and the sentence that says so.
pub(crate) fn stamps(
    name: &str,
    has_unit: bool,
    first: Option<i128>,
    values: &[f64],
) -> (Option<&'static str>, String) {
    let stated = || format!("column `{name}` begins at 0: it counted from another moment");
    let (Some(first), Some(step), false) = (first, median_step(values), has_unit) else {
        return (None, stated());
    };
    match since_1970(first as f64 / 1e9, step) {
        Some(unit) => (Some(unit), epoch(name, unit)),
        None => match by_step(step) {
            Some(unit) => (Some(unit), guessed(name, unit, step)),
            None => (None, stated()),
        },
    }
}

fn epoch(name: &str, unit: &str) -> String {
    format!("column `{name}` counts {unit} since 1970: read as s since its first row")
}

fn guessed(name: &str, unit: &str, step: f64) -> String {
    let counter = if step == 1.0 { ", or it counts rows" } else { "" };
    let step = digits(step);
    format!(
        "column `{name}` has no unit: its median step of {step} is taken as {step} {unit}, a \
         guess{counter}; say another with --columns time={name}:UNIT"
    )
}

/// The unit of a stamp that counts from 1970.
fn since_1970(first: f64, step: f64) -> Option<&'static str> {
    let units = [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)];
    let within = |factor: f64| (LEAST_EPOCH * factor..LARGEST_EPOCH * factor).contains(&first);
    let found = units.into_iter().find(|(_, factor)| within(*factor))?;
    (found.0 != "s" || step < SLOWEST_EPOCH).then_some(found.0)
}

pub(crate) fn by_step(step: f64) -> Option<&'static str> {
    match step {
        _ if step < SECONDS_BELOW => None,
        _ if step < MILLISECONDS_BELOW => Some("ms"),
        _ if step < MICROSECONDS_BELOW => Some("us"),
        _ => Some("ns"),
    }
}

/// Median of the steps forward.
pub(crate) fn median_step(time: &[f64]) -> Option<f64> {
    let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0 && step.is_finite()).collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    Some(*steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_since_1970_tell_their_unit_by_size() {
        for (first, step, unit) in [
            (1.7e9, 0.01, Some("s")),
            (1.7e9, 1000.0, None),
            (1.7e12, 10.0, Some("ms")),
            (1.7e15, 1e4, Some("us")),
            (1.7e18, 1e7, Some("ns")),
            (5.0, 0.01, None),
        ] {
            assert_eq!(since_1970(first, step), unit, "{first}");
        }
    }

    #[test]
    fn steps_that_no_drive_would_be_sampled_at_are_smaller_units() {
        for (step, unit) in [
            (0.01, None),
            (0.5, Some("ms")),
            (1.0, Some("ms")),
            (1000.0, Some("us")),
            (1e6, Some("ns")),
        ] {
            assert_eq!(by_step(step), unit, "{step}");
        }
        assert!(guessed("t", "ms", 1.0).contains("counts rows"));
    }
}
