//! The time column: uniform within 1 %, or where and how it is not.

use crate::error::Error;
use crate::place::Lines;
use crate::report::{Sampling, Stretches};

/// Largest departure of a time step from the others, relative.
pub(crate) const UNIFORM: f64 = 0.01;
/// A longer step than so many median steps has lost samples.
const GAP_STEPS: f64 = 1.5;
/// A time stamp farther than so many steps off the grid belongs to another sample.
const DRIFT_STEPS: f64 = 0.5;

/// Checks that time is uniform within 1 % and never half a step off its grid.
pub(crate) fn uniform(time: &[f64], lines: &Lines) -> Result<Sampling, Error> {
    finite(time, lines)?;
    let (first, last, steps) = (time[0], time[time.len() - 1], (time.len() - 1) as f64);
    let mean = (last - first) / steps;
    if !mean.is_finite() {
        let (file, duration_s) = (lines.file().to_owned(), last - first);
        return Err(Error::Period { file, period_s: mean, duration_s });
    }
    let mut jitter = 0.0_f64;
    let mut off = (0, 0.0_f64);
    for k in 1..time.len() {
        jitter = jitter.max((time[k] - time[k - 1] - mean).abs() / mean);
        let drift = (time[k] - (first + k as f64 * mean)).abs();
        if drift > off.1 {
            off = (k, drift);
        }
    }
    if !(mean > 0.0 && jitter <= UNIFORM) {
        located(time, lines)?;
    }
    let period_s = shortest_period(first, last, steps);
    if !(mean > 0.0 && off.1 <= DRIFT_STEPS * mean) {
        return Err(Error::Drift { place: lines.place(off.0), off_s: off.1, period_s });
    }
    Ok(Sampling { start_s: first, period_s, jitter, resampled_from_s: None })
}

/// What resampling leaves out or bridges.
pub(crate) struct Repairs {
    pub(crate) median_s: f64,
    pub(crate) gaps: Stretches,
    pub(crate) repeated: Stretches,
}

/// Looks for what resampling cannot mend (time that is missing or goes back) and notes what it
/// mends: gaps, and repeated rows, which are named by the row that is left out.
pub(crate) fn mendable(time: &[f64], lines: &Lines) -> Result<Repairs, Error> {
    finite(time, lines)?;
    let median_s = median_step(time);
    let mut repairs =
        Repairs { median_s, gaps: Stretches::default(), repeated: Stretches::default() };
    for k in 1..time.len() {
        let step = time[k] - time[k - 1];
        if step < 0.0 {
            let (from_s, to_s) = (time[k - 1], time[k]);
            return Err(Error::TimeBackwards { place: lines.place(k), from_s, to_s });
        }
        if step == 0.0 {
            repairs.repeated.add(k, lines.line(k));
        } else if step > GAP_STEPS * median_s {
            repairs.gaps.add(k, lines.line(k));
        }
    }
    Ok(repairs)
}

/// Samples every `period_s` within the recording.
pub(crate) fn samples(file: &str, time: &[f64], period_s: f64) -> Result<usize, Error> {
    let duration_s = match time {
        [first, .., last] => last - first,
        _ => 0.0,
    };
    // Not longer than 2^40 samples: a sampling time of 1e-300 s is a slip of the pen.
    let steps = duration_s / period_s;
    if period_s.is_finite() && period_s > 0.0 && (1.0 - 1e-9..1e12).contains(&steps) {
        // The last sample counts when rounding alone puts it beyond the end.
        return Ok((steps + 1e-9).floor() as usize + 1);
    }
    Err(Error::Period { file: file.to_owned(), period_s, duration_s })
}

/// Values at `time[0] + k * period_s`, on the straight line between their neighbours.
///
/// `time` must not go back; of rows with the same time the first counts.
pub(crate) fn interpolate(time: &[f64], values: &[f64], period_s: f64, samples: usize) -> Vec<f64> {
    let later = |left: usize| {
        let same = time[left..].iter().take_while(|other| **other <= time[left]).count();
        left + same
    };
    let (mut left, mut right) = (0, later(0));
    let mut result = Vec::with_capacity(samples);
    for k in 0..samples {
        let at = time[0] + k as f64 * period_s;
        while right < time.len() && time[right] < at {
            left = right;
            right = later(left);
        }
        result.push(match time.get(right) {
            Some(next) if at > time[left] => {
                let share = (at - time[left]) / (next - time[left]);
                // Exact at both ends, so that resampling to the same grid changes nothing.
                if share >= 1.0 {
                    values[right]
                } else {
                    values[left] + share * (values[right] - values[left])
                }
            }
            _ => values[left],
        });
    }
    result
}

fn finite(time: &[f64], lines: &Lines) -> Result<(), Error> {
    match time.iter().position(|time| !time.is_finite()) {
        Some(k) => Err(Error::TimeNotFinite { place: lines.place(k) }),
        None => Ok(()),
    }
}

/// The first step that departs from the median by more than 1 %, as an error.
fn located(time: &[f64], lines: &Lines) -> Result<(), Error> {
    let median_s = median_step(time);
    for k in 1..time.len() {
        let (step_s, place) = (time[k] - time[k - 1], || lines.place(k));
        if step_s < 0.0 {
            let (from_s, to_s) = (time[k - 1], time[k]);
            return Err(Error::TimeBackwards { place: place(), from_s, to_s });
        }
        if step_s == 0.0 {
            return Err(Error::TimeRepeated { place: place(), at_s: time[k], median_s });
        }
        if step_s > GAP_STEPS * median_s {
            return Err(Error::Gap { place: place(), step_s, median_s });
        }
        if (step_s - median_s).abs() > UNIFORM * median_s {
            return Err(Error::NonUniform { place: place(), step_s, median_s });
        }
    }
    Ok(())
}

fn median_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The period with the fewest digits that the first and last time stamp allow.
///
/// `(last - first) / steps` carries their rounding: 0.001 s would come back as
/// 0.0009999999999999998 s. Whatever lies within that rounding explains them as well.
fn shortest_period(first: f64, last: f64, steps: f64) -> f64 {
    let mean = (last - first) / steps;
    let rounding = f64::EPSILON * (first.abs().max(last.abs()) / steps + mean.abs());
    (0..17)
        .map(|digits| format!("{mean:.digits$e}"))
        .filter_map(|text| text.parse::<f64>().ok())
        .find(|short| (short - mean).abs() <= rounding)
        .unwrap_or(mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::Lines;

    fn error(time: &[f64]) -> Error {
        uniform(time, &Lines::rows("a")).unwrap_err()
    }

    #[test]
    fn decimal_sampling_times_come_back_as_they_are() {
        for period in [0.001, 0.005, 1e-4, 0.0003, 1.0 / 3.0, 2.5e-5, 0.02] {
            for samples in [2, 3, 1000, 24_841] {
                let time: Vec<f64> = (0..samples).map(|k| 7.0 + f64::from(k) * period).collect();
                let sampling = uniform(&time, &Lines::rows("a")).unwrap();
                let off = (sampling.period_s - period).abs();
                // 1/3 s has no short form: it is known to the rounding of the stamps only.
                let allowed = if period == 1.0 / 3.0 { 1e-15 * f64::from(samples) } else { 0.0 };
                assert!(off <= allowed, "{period} over {samples}: {}", sampling.period_s);
            }
        }
    }

    #[test]
    fn one_per_cent_passes_and_two_do_not() {
        let jittered = |share: f64| -> Vec<f64> {
            (0..100).map(|k| f64::from(k) + if k % 2 == 0 { 0.0 } else { share }).collect()
        };
        assert!(uniform(&jittered(0.009), &Lines::rows("a")).unwrap().jitter > 0.008);
        assert!(matches!(error(&jittered(0.02)), Error::NonUniform { .. }));
    }

    #[test]
    fn each_kind_of_bad_time_has_its_own_name_and_place() {
        let place = |error: &Error| match error {
            Error::TimeBackwards { place, .. }
            | Error::TimeRepeated { place, .. }
            | Error::Gap { place, .. }
            | Error::NonUniform { place, .. }
            | Error::Drift { place, .. }
            | Error::TimeNotFinite { place } => place.at,
            other => panic!("{other}"),
        };
        let backwards = error(&[0.0, 1.0, 2.0, 1.5, 3.0, 4.0]);
        assert!(matches!(backwards, Error::TimeBackwards { .. }) && place(&backwards) == 4);
        let repeated = error(&[0.0, 1.0, 2.0, 2.0, 3.0, 4.0]);
        assert!(matches!(repeated, Error::TimeRepeated { .. }) && place(&repeated) == 4);
        let gap = error(&[0.0, 1.0, 2.0, 7.0, 8.0, 9.0]);
        assert!(matches!(gap, Error::Gap { step_s: 5.0, median_s: 1.0, .. }) && place(&gap) == 4);
        let missing = error(&[0.0, f64::NAN, 2.0]);
        assert!(matches!(missing, Error::TimeNotFinite { .. }) && place(&missing) == 2);
        // Steps of 0.995 and then 1.005: each within 1 % of the mean, yet 2.5 samples off.
        let drifting: Vec<f64> =
            (0..1001).map(|k: i32| f64::from(k) + 0.005 * f64::from((k - 500).abs())).collect();
        assert!(matches!(error(&drifting), Error::Drift { .. }));
        assert!(matches!(error(&[5.0, 4.0]), Error::TimeBackwards { .. }));
        assert!(matches!(error(&[5.0, 5.0]), Error::TimeRepeated { .. }));
    }

    #[test]
    fn interpolation_bridges_gaps_and_keeps_the_first_of_repeated_rows() {
        let time = [0.0, 1.0, 1.0, 1.0, 4.0];
        let values = [0.0, 10.0, 99.0, 98.0, 40.0];
        let samples = samples("a", &time, 0.5).unwrap();
        let read = interpolate(&time, &values, 0.5, samples);
        assert_eq!(read, [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0]);
        let repairs = mendable(&time, &Lines::rows("a")).unwrap();
        assert_eq!((repairs.repeated.samples, repairs.gaps.samples), (2, 1));
        assert!(mendable(&[0.0, 1.0, 0.5], &Lines::rows("a")).is_err());
    }
}
