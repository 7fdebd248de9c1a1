//! A sensor that keeps one value while everything else moves: a lost bus, a hung logger.
//!
//! A coarse sensor keeps its value too, and at rest every one does. Frozen is a stay that is many
//! times longer than the others of that signal, while another signal goes through much of its
//! range; and where stays are usual, one that ends with a jump.

use std::ops::Range;

use drivescope_recording::{Recording, Signal, rounded_to};

use super::finding::{Consequence, SignalFinding, Size, Stretch, What};

/// What may freeze, and whether zero is a rest.
const CHANNELS: [(&str, bool); 8] = [
    ("omega", true),
    ("v", true),
    ("T", true),
    ("i", true),
    ("I_m", true),
    ("theta", false),
    ("x", false),
    ("theta_load", false),
];
/// What else moves.
const OTHERS: [&str; 10] = ["u", "C_m", "torque", "i", "I_m", "omega", "v", "T", "theta", "x"];
/// Shortest stay, samples: what is shorter bends nothing.
const SHORTEST: usize = 20;
/// How many times longer than nearly all other stays.
const LONGER: f64 = 10.0;
/// Share of the stays that are not counted to the others: frozen stretches are few.
const FEW: f64 = 0.01;
/// Share of its range that another signal goes through meanwhile.
const MOVES: f64 = 0.2;
/// Levels of a signal below which stays are usual: one count a sample is a speed, too.
const LEVELS: usize = 100;
/// Where stays are usual, the change at the end over the largest usual one.
const JUMP: f64 = 3.0;

/// Sets frozen stretches to missing.
pub(super) fn repair(recording: &mut Recording) -> Vec<SignalFinding> {
    let clock = recording.clock();
    let mut found = Vec::new();
    for (name, rests_at_zero) in CHANNELS {
        let Some(signal) = recording.signal(name) else { continue };
        let stays: Vec<Range<usize>> = of(&signal.values, rests_at_zero)
            .into_iter()
            .filter(|stay| others_move(recording, name, stay))
            .collect();
        let Some(longest) = stays.iter().max_by_key(|stay| stay.len()).cloned() else { continue };
        let samples: usize = stays.iter().map(|stay| stay.len()).sum();
        let at = Stretch::of(longest, &clock);
        let Some(signal) = recording.signals.iter_mut().find(|it| it.name == name) else {
            continue;
        };
        let value = signal.values[at.from];
        stays.into_iter().for_each(|stay| signal.values[stay].fill(f64::NAN));
        let unit = &signal.unit;
        found.push(SignalFinding {
            recording: recording.name.clone(),
            channel: name.to_owned(),
            what: What::Frozen,
            at: Some(at),
            size: Size { value: samples as f64, of: "samples" },
            consequence: Consequence::Repaired,
            sentence: format!(
                "{name} keeps the value {} {unit} from {:.4} s to {:.4} s while the others move \
                 ({samples} samples so in all), set to missing",
                rounded_to(6, value),
                at.from_s,
                at.to_s
            ),
            next: "check the sensor's bus or the logger".to_owned(),
        });
    }
    found
}

/// Stays that no sensor of a moving machine makes.
fn of(values: &[f64], rests_at_zero: bool) -> Vec<Range<usize>> {
    let mut stays: Vec<Range<usize>> = Vec::new();
    for k in 1..values.len() {
        if values[k] == values[k - 1] {
            match stays.last_mut().filter(|last| last.end == k) {
                Some(last) => last.end = k + 1,
                None => stays.push(k - 1..k + 1),
            }
        }
    }
    let finite = || values.iter().copied().filter(|it| it.is_finite());
    let (low, high) =
        finite().fold((f64::MAX, f64::MIN), |(low, high), it| (low.min(it), high.max(it)));
    let long = |value: f64| {
        stays.iter().filter(|it| it.len() >= SHORTEST && values[it.start] == value).count()
    };
    // What is cut off stays at its limit more than once, and a speed of zero is a rest.
    let limits = [low, high].map(|value| (value, long(value) > 1));
    let counts = |stay: &Range<usize>| {
        let value = values[stay.start];
        !(limits.contains(&(value, true)) || rests_at_zero && value == 0.0)
    };
    stays.retain(counts);
    let repeated: usize = stays.iter().map(|stay| stay.len() - 1).sum();
    let singles = values.len().saturating_sub(repeated + stays.len());
    let mut lengths: Vec<usize> = stays.iter().map(|stay| stay.len()).collect();
    lengths.extend(std::iter::repeat_n(1, singles));
    lengths.sort_unstable();
    let Some(usual) = lengths.get(lengths.len().saturating_sub(1 + few(lengths.len()))) else {
        return Vec::new();
    };
    let least = (LONGER * *usual as f64).max(SHORTEST as f64) as usize;
    let largest = usual_change(values);
    let often = 2 * repeated > values.len() || has_few_levels(values);
    let jumps = |stay: &Range<usize>| {
        let after = values.get(stay.end).copied().unwrap_or(f64::NAN);
        (after - values[stay.start]).abs() > JUMP * largest
    };
    stays.retain(|stay| stay.len() >= least && (!often && rests_at_zero || jumps(stay)));
    stays
}

fn has_few_levels(values: &[f64]) -> bool {
    let mut seen: Vec<f64> = Vec::new();
    for value in values.iter().filter(|it| it.is_finite()) {
        if !seen.contains(value) {
            seen.push(*value);
        }
        if seen.len() >= LEVELS {
            return false;
        }
    }
    true
}

fn few(count: usize) -> usize {
    ((FEW * count as f64) as usize).max(3)
}

/// Nearly the largest change from sample to sample.
fn usual_change(values: &[f64]) -> f64 {
    let mut all: Vec<f64> = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|it| it.is_finite())
        .collect();
    if all.is_empty() {
        return f64::INFINITY;
    }
    let at = all.len().saturating_sub(1 + few(all.len()));
    *all.select_nth_unstable_by(at, f64::total_cmp).1
}

/// Whether another signal goes through much of its range in that stretch.
fn others_move(recording: &Recording, name: &str, stay: &Range<usize>) -> bool {
    let range = |values: &[f64]| {
        let finite = values.iter().copied().filter(|it| it.is_finite());
        let (low, high) =
            finite.fold((f64::MAX, f64::MIN), |(low, high), it| (low.min(it), high.max(it)));
        (high - low).max(0.0)
    };
    let moves = |signal: &Signal| {
        OTHERS.contains(&signal.name.as_str())
            && signal.name != name
            && range(&signal.values[stay.clone()]) > MOVES * range(&signal.values)
    };
    recording.signals.iter().any(moves)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    fn freeze(recording: &mut Recording, name: &str, stay: Range<usize>) {
        let signal = recording.signals.iter_mut().find(|it| it.name == name);
        let values = &mut signal.expect("it is there").values;
        let value = values[stay.start];
        values[stay].fill(value);
    }

    #[test]
    fn frozen_stretches_are_set_to_missing() {
        let clean = noisy(bench(&dr300(), 3.0, 0.001), [0.01, 0.3], 7);
        let mut untouched = clean.clone();
        assert_eq!(repair(&mut untouched), []);
        for name in ["i", "omega", "theta"] {
            let mut frozen = clean.clone();
            freeze(&mut frozen, name, 700..1100);
            let found = repair(&mut frozen);
            let [one] = &found[..] else { panic!("{name}: {found:?}") };
            let at = one.at.expect("a place");
            assert_eq!((one.channel.as_str(), at.from, at.to), (name, 700, 1099));
            let values = &frozen.signal(name).expect("it is there").values;
            let gone = values.iter().filter(|it| it.is_nan()).count();
            assert!(gone == 400 && values[1100].is_finite(), "{gone}");
        }
    }

    #[test]
    fn rest_coarse_steps_and_limits_are_not_frozen() {
        let mut recording = bench(&dr300(), 3.0, 0.001);
        for signal in &mut recording.signals {
            match signal.name.as_str() {
                // A coarse encoder and a coarse tachometer, and a current that is cut off.
                "theta" => signal.values.iter_mut().for_each(|it| *it = (*it / 0.5).round() * 0.5),
                "omega" => signal.values.iter_mut().for_each(|it| *it = (*it / 5.0).round() * 5.0),
                "i" => signal.values.iter_mut().for_each(|it| *it = it.clamp(-0.4, 0.5)),
                _ => {}
            }
        }
        assert_eq!(repair(&mut recording), []);
    }
}
