//! A position that a row repeats while the shaft moves on: the sensor was read more often than it answers,
//! and now and then the answer is the last one again.
//!
//! What such a row is off by grows with the speed and is no noise of the sensor; it hides an inertia from
//! whatever differentiates the position. A coarse sensor repeats its value too, where the shaft moves by
//! less than a level; a stop lasts, and begins and ends slowly.

use drivescope_recording::{Quantum, Recording, Signal};

use super::finding::{Consequence, SignalFinding, Size, Stretch, What};

/// What shows a way.
pub(super) const POSITIONS: [&str; 4] = ["theta", "x", "theta_load", "x_load"];
/// Levels by which the position changes at least before and after, in the same direction.
const LEVELS: f64 = 4.0;
/// Rows that are repeated one after the other, at most: a longer stay may be a stop.
const LONGEST: usize = 2;
/// Fewer are no habit, nor is a smaller share of all rows.
const FEWEST: usize = 5;
const SHARE: f64 = 1e-3;

/// Puts repeated rows on the line between their neighbours.
pub(super) fn repair(recording: &mut Recording) -> Vec<SignalFinding> {
    let (clock, segments) = (recording.clock(), recording.segments());
    let name = recording.name.clone();
    let mut found = Vec::new();
    for signal in &mut recording.signals {
        if !POSITIONS.contains(&signal.name.as_str()) {
            continue;
        }
        let least = LEVELS * Quantum::of(&signal.values).map_or(0.0, |quantum| quantum.step);
        let each = segments.iter().flat_map(|segment| {
            let inside = of(&signal.values[segment.clone()], least).into_iter();
            inside.map(|(first, count)| (segment.start + first, count))
        });
        let stays: Vec<(usize, usize)> = each.collect();
        let rows: usize = stays.iter().map(|(_, count)| count).sum();
        let (Some((first, _)), Some((last, count))) = (stays.first(), stays.last()) else {
            continue;
        };
        if rows < FEWEST || (rows as f64) < SHARE * signal.values.len() as f64 {
            continue;
        }
        let at = Stretch::of(first + 1..last + count + 1, &clock);
        let Signal { name: channel, values, .. } = signal;
        for (first, count) in stays {
            let (from, step) = (values[first], values[first + count + 1] - values[first]);
            for k in 1..=count {
                values[first + k] = from + step * k as f64 / (count + 1) as f64;
            }
        }
        found.push(SignalFinding {
            recording: name.clone(),
            channel: channel.clone(),
            what: What::Repeated,
            at: Some(at),
            size: Size { value: rows as f64, of: "samples" },
            consequence: Consequence::Repaired,
            sentence: format!(
                "{rows} rows of {channel} repeat the last value while the shaft moves on, put on the \
                 line between their neighbours"
            ),
            next: format!("record {channel} no more often than its sensor answers"),
        });
    }
    found
}

/// The sample before each stay, and how many rows repeat it.
fn of(values: &[f64], least: f64) -> Vec<(usize, usize)> {
    let mut stays = Vec::new();
    let mut first = 0;
    for stay in values.chunk_by(|a, b| a == b) {
        let (count, end) = (stay.len() - 1, first + stay.len());
        if (1..=LONGEST).contains(&count) && first > 0 && end < values.len() {
            let [before, after] = [stay[0] - values[first - 1], values[end] - stay[0]];
            // NaN compares with nothing.
            if before * after > 0.0 && before.abs().min(after.abs()) >= least {
                stays.push((first, count));
            }
        }
        first = end;
    }
    stays
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300};

    fn angle(recording: &mut Recording) -> &mut Vec<f64> {
        let signal = recording.signals.iter_mut().find(|it| it.name == "theta");
        &mut signal.expect("it is there").values
    }

    #[test]
    fn rows_that_repeat_a_moving_shaft_are_found_and_those_of_a_coarse_sensor_are_not() {
        let mut clean = bench(&dr300(), 3.0, 0.001);
        assert_eq!(repair(&mut clean.clone()), []);
        // A sensor of 500 lines: at slow speed it shows a level for several rows.
        angle(&mut clean).iter_mut().for_each(|it| *it = (*it / 0.00314).round() * 0.00314);
        assert_eq!(repair(&mut clean.clone()), []);
        let fine = |it: &mut f64| *it = (*it / 1e-5).round() * 1e-5;
        let mut truth = bench(&dr300(), 3.0, 0.001);
        angle(&mut truth).iter_mut().for_each(fine);
        let mut repeated = truth.clone();
        let values = angle(&mut repeated);
        for k in (500..2500).step_by(7) {
            values[k] = values[k - 1];
        }
        let off = |recording: &mut Recording| {
            let each = angle(recording).clone().into_iter().zip(angle(&mut truth.clone()).clone());
            each.fold(0.0_f64, |most, (is, was)| most.max((is - was).abs()))
        };
        let before = off(&mut repeated);
        let found = repair(&mut repeated);
        assert_eq!((found.len(), found[0].what), (1, What::Repeated));
        assert!(found[0].size.value > 200.0, "{:?}", found[0].size);
        assert!(off(&mut repeated) < 0.2 * before, "{} of {before}", off(&mut repeated));
    }
}
