//! Whether speed and position are shown at the same time: two sensors of one motion, of which one is
//! filtered or sent later.
//!
//! The position's change over a few samples is the mean of the speed over them. That mean is held
//! against the change at every shift; at the right one the least is left of it.

use std::ops::Range;

use drivescope_plant::drive::Drive;
use drivescope_recording::rounded_to;

use super::finding::{Consequence, SignalFinding, Size, What};
use crate::estimate::Evidence;
use crate::measured::{Measured, Output};

/// Samples on either side over which the position's change is taken.
const REACH: usize = 2;
/// Longest shift looked at, s, and in samples.
const LONGEST_S: f64 = 0.1;
const MOST: usize = 250;
/// What may be left at the shift, of what is left without one; and of the change itself.
const CLEARLY: f64 = 0.5;
const LITTLE: f64 = 0.1;
/// What rounding leaves of it.
const ROUNDING: f64 = 1e-12;
/// Fewest samples.
const FEWEST: usize = 100;

/// The findings.
pub(super) fn check(_: &Drive, evidence: &Evidence) -> Vec<SignalFinding> {
    evidence.recordings.iter().filter_map(of).collect()
}

fn of(measured: &Measured) -> Option<SignalFinding> {
    let speed = &measured.output(Output::Speed)?.values;
    let late_s = shift(speed, measured.angle.as_deref()?, measured)? * measured.period_s;
    let (late, other) = if late_s > 0.0 { ("omega", "theta") } else { ("theta", "omega") };
    let by = rounded_to(2, 1e3 * late_s.abs());
    Some(SignalFinding {
        recording: measured.name.clone(),
        channel: late.to_owned(),
        what: What::Late,
        at: None,
        size: Size { value: late_s.abs(), of: "s late" },
        consequence: Consequence::Limits,
        sentence: format!(
            "{late} shows the motion {by} ms later than {other}: its sensor is filtered or sent later"
        ),
        next: format!(
            "record both at once and unfiltered, or keep {late} out with --columns {late}_unused={late}"
        ),
    })
}

/// Samples by which the speed comes after the position's change; nothing where they come together, or
/// do not tell.
fn shift(speed: &[f64], angle: &[f64], measured: &Measured) -> Option<f64> {
    let most = ((LONGEST_S / measured.period_s) as usize).clamp(1, MOST) as isize;
    let left = |lag: isize| left_at(speed, angle, &measured.pieces, (lag, most));
    // A position that was integrated from the speed comes at once.
    let at_once = left(0).filter(|share| *share > ROUNDING)?;
    let all: Vec<f64> = (-most..=most).map(left).collect::<Option<_>>()?;
    let best = (0..all.len()).min_by(|a, b| all[*a].total_cmp(&all[*b]))?;
    if best as isize == most || all[best] > CLEARLY * at_once || all[best] > LITTLE {
        return None;
    }
    // Between samples, by the parabola through three of them.
    let between = match (best.checked_sub(1).map(|k| all[k]), all.get(best + 1)) {
        (Some(before), Some(after)) => {
            let bent = before - 2.0 * all[best] + after;
            if bent > 0.0 { 0.5 * (before - after) / bent } else { 0.0 }
        }
        _ => 0.0,
    };
    Some(best as f64 - most as f64 + between)
}

/// Share of the position's changes that the speed so many samples later does not go with.
fn left_at(
    speed: &[f64],
    angle: &[f64],
    pieces: &[Range<usize>],
    (lag, most): (isize, isize),
) -> Option<f64> {
    let margin = REACH + most as usize;
    let (mut n, mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for piece in pieces.iter().filter(|piece| piece.len() > 2 * margin) {
        for k in piece.start + margin..piece.end - margin {
            let change = (angle[k + REACH] - angle[k - REACH]) / (2 * REACH) as f64;
            let around = k.checked_add_signed(lag)?;
            let near = &speed[around - REACH..=around + REACH];
            // The trapezoidal rule over the samples between.
            let mean =
                (near.iter().sum::<f64>() - 0.5 * (near[0] + near[2 * REACH])) / (2 * REACH) as f64;
            if change.is_finite() && mean.is_finite() {
                n += 1.0;
                (x, y) = (x + mean, y + change);
                (xx, xy, yy) = (xx + mean * mean, xy + mean * change, yy + change * change);
            }
        }
    }
    let (sxx, sxy, syy) = (xx - x * x / n, xy - x * y / n, yy - y * y / n);
    (n >= FEWEST as f64 && sxx > 0.0 && syy > 0.0).then(|| 1.0 - sxy * sxy / (sxx * syy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    #[test]
    fn a_filtered_speed_is_told_and_one_that_comes_at_once_is_not() {
        let drive = dr300();
        let found = |late_s: f64, with_position: bool| {
            let mut recording = noisy(bench(&drive, 4.0, 0.001), [0.01, 0.3], 7);
            let place = recording.signals.iter().position(|it| it.name == "omega").expect("there");
            let keeps = (-0.001 / late_s).exp();
            let mut shown = recording.signals[place].values[0];
            for value in &mut recording.signals[place].values {
                shown = keeps * shown + (1.0 - keeps) * *value;
                *value = shown;
            }
            recording.signals.retain(|it| with_position || it.name != "theta");
            let measured = Measured::new(&drive, &recording).expect("usable");
            check(&drive, &Evidence { recordings: vec![measured], noise: vec![vec![0.01, 0.3]] })
        };
        assert_eq!(found(1e-6, true), []);
        assert_eq!(found(0.015, false), []);
        let late = found(0.015, true);
        let [one] = &late[..] else { panic!("{late:?}") };
        assert_eq!((one.what, one.channel.as_str()), (What::Late, "omega"));
        assert!((one.size.value / 0.015 - 1.0).abs() < 0.4, "{one:?}");
        assert!(one.sentence.contains("later than theta"), "{}", one.sentence);
    }
}
