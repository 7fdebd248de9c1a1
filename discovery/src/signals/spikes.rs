//! Single samples far beside their neighbours: a disturbed wire or a lost byte, no motion.
//!
//! A shaft has inertia: a speed or a position that leaves for one sample and is back in the next
//! was not there. A current and a voltage may leave and come back; of them only such values are
//! spikes that are far beyond all others as well.

use drivescope_recording::{Recording, Signal};

use super::finding::{Consequence, SignalFinding, Size, Stretch, What};
use super::repeated::POSITIONS;

/// What, beside the positions, does not jump: a shaft has inertia, and a winding heat capacity.
const SLOW: [&str; 5] = ["omega", "v", "T", "omega_load", "v_load"];
/// What may jump.
const QUICK: [&str; 6] = ["u", "i", "I_m", "C_m", "torque", "T_l"];
/// Spikes are fewer than one in so many samples; a signal with more is noisy.
const RARE: usize = 200;
/// Samples that one spike moves away from the middle of their neighbours.
const TOUCHED: usize = 3;
/// How many times further out than any other sample a spike is: the largest of a million normal
/// deviations is 5 times the standard deviation, and heavy tails go some times beyond.
const BEYOND: f64 = 8.0;
/// Share of the range below which nothing is called a spike, over [`BEYOND`].
const SMALL: f64 = 0.01;
/// The neighbours agree within this share of the spike.
const AGREE: f64 = 0.25;
/// Spikes that are told one by one.
const LISTED: usize = 3;

/// Sets spikes to missing.
pub(super) fn repair(recording: &mut Recording) -> Vec<SignalFinding> {
    let (clock, segments) = (recording.clock(), recording.segments());
    let name = recording.name.clone();
    let mut found = Vec::new();
    for signal in &mut recording.signals {
        let quick = QUICK.contains(&signal.name.as_str());
        if !quick && !POSITIONS.iter().chain(&SLOW).any(|name| *name == signal.name) {
            continue;
        }
        let mut spikes: Vec<usize> = Vec::new();
        let least = threshold(&signal.values);
        for segment in &segments {
            let inside = &signal.values[segment.clone()];
            spikes.extend(of(inside, least).into_iter().map(|k| segment.start + k));
        }
        if quick {
            spikes = beyond_all(&signal.values, spikes);
        }
        let (Some(first), Some(last)) = (spikes.first(), spikes.last()) else { continue };
        let at = Stretch::of(*first..last + 1, &clock);
        let times = |k: &usize| format!("{:.4} s", clock.time(*k));
        let mut places: Vec<String> = spikes.iter().take(LISTED).map(times).collect();
        if spikes.len() > LISTED {
            places.push("...".to_owned());
        }
        let far = |k: &usize| aside(&signal.values, *k).map_or(0.0, f64::abs);
        let worst = spikes.iter().max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(first);
        let (worst, count) = (signal.values[*worst], spikes.len());
        let samples = if count == 1 { "one sample".to_owned() } else { format!("{count} samples") };
        let Signal { name: channel, unit, values } = signal;
        spikes.iter().for_each(|k| values[*k] = f64::NAN);
        found.push(SignalFinding {
            recording: name.clone(),
            channel: channel.clone(),
            what: What::Spikes,
            at: Some(at),
            size: Size { value: count as f64, of: "samples" },
            consequence: Consequence::Repaired,
            sentence: format!(
                "{samples} of {channel} far beside the neighbours (as {worst} {unit}; at \
                 {}), set to missing",
                places.join(", ")
            ),
            next: "check the wiring of the sensor if there are many".to_owned(),
        });
    }
    found
}

/// How far sample `k` is from the middle of its neighbours; none at an end or beside a hole.
fn aside(values: &[f64], k: usize) -> Option<f64> {
    let (before, after) = (values.get(k.checked_sub(1)?)?, values.get(k + 1)?);
    let aside = values[k] - 0.5 * (before + after);
    aside.is_finite().then_some(aside)
}

/// How far aside a spike is at least.
fn threshold(values: &[f64]) -> f64 {
    let mut all: Vec<f64> =
        (0..values.len()).filter_map(|k| aside(values, k)).map(f64::abs).collect();
    let most = TOUCHED * (all.len() / RARE).max(LISTED);
    if all.len() <= 2 * most {
        return f64::INFINITY;
    }
    let at = all.len() - 1 - most;
    let usual = *all.select_nth_unstable_by(at, f64::total_cmp).1;
    let mut finite: Vec<f64> = values.iter().copied().filter(|it| it.is_finite()).collect();
    let ends = finite.len() / RARE + LISTED;
    finite.sort_by(f64::total_cmp);
    let range = finite[finite.len() - 1 - ends] - finite[ends];
    BEYOND * usual.max(SMALL * range)
}

/// Single samples that are at least so far aside, with neighbours that agree.
fn of(values: &[f64], least: f64) -> Vec<usize> {
    let far = |k: &usize| {
        let Some(aside) = aside(values, *k).filter(|aside| aside.abs() > least) else {
            return false;
        };
        (values[k + 1] - values[k - 1]).abs() < AGREE * aside.abs()
    };
    (0..values.len()).filter(far).collect()
}

/// Those that are further from all other values than these are from each other.
fn beyond_all(values: &[f64], spikes: Vec<usize>) -> Vec<usize> {
    let others = values.iter().enumerate().filter(|(k, it)| it.is_finite() && !spikes.contains(k));
    let (low, high) = others.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, value)| {
        (low.min(*value), high.max(*value))
    });
    let reach = 0.5 * BEYOND * (high - low);
    // Where nothing else changes, a pulse is the experiment.
    let out = |k: &usize| values[*k] > high + reach || values[*k] < low - reach;
    if high > low { spikes.into_iter().filter(out).collect() } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300, noisy};

    fn column<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
        &recording.signal(name).expect("it is there").values
    }

    #[test]
    fn single_samples_far_out_are_set_to_missing() {
        let drive = dr300();
        let clean = noisy(bench(&drive, 3.0, 0.001), [0.01, 0.3], 7);
        let mut untouched = clean.clone();
        assert_eq!(repair(&mut untouched), []);
        assert_eq!(untouched, clean);
        let mut spiked = clean.clone();
        for (name, k, value) in
            [("omega", 700, 1e9), ("omega", 1900, -400.0), ("i", 50, 1e3), ("u", 60, -1e9)]
        {
            let signal = spiked.signals.iter_mut().find(|it| it.name == name);
            signal.expect("it is there").values[k] = value;
        }
        let found = repair(&mut spiked);
        let sizes: Vec<_> = found.iter().map(|it| (it.channel.as_str(), it.size.value)).collect();
        assert_eq!(sizes, [("u", 1.0), ("i", 1.0), ("omega", 2.0)]);
        let at = found[2].at.expect("a place");
        assert!((at.from, at.to) == (700, 1900) && (at.from_s - 0.7).abs() < 1e-12, "{at:?}");
        for name in ["u", "i", "omega"] {
            for (k, (now, was)) in
                column(&spiked, name).iter().zip(column(&clean, name)).enumerate()
            {
                let hit = matches!((name, k), ("omega", 700 | 1900) | ("i", 50) | ("u", 60));
                assert!(if hit { now.is_nan() } else { now == was }, "{name} {k}");
            }
        }
    }

    #[test]
    fn steps_pulses_and_wrapping_angles_are_no_spikes() {
        let drive = dr300();
        let mut recording = noisy(bench(&drive, 3.0, 0.001), [0.01, 0.3], 7);
        for signal in &mut recording.signals {
            match signal.name.as_str() {
                "theta" => signal
                    .values
                    .iter_mut()
                    .for_each(|it| *it = it.rem_euclid(std::f64::consts::TAU)),
                // An impulse and its response.
                "u" => signal.values = (0..3000).map(|k| f64::from(k == 1000) * 20.0).collect(),
                _ => {}
            }
        }
        assert_eq!(repair(&mut recording), []);
    }
}
