//! One signal by itself: range, holes, limits, steps of quantisation, excitation.

use serde::Serialize;

use crate::place::Lines;
use crate::quantum::{Quantum, quantum};
use crate::rounded;
use crate::stretches::Stretches;

/// A signal with so few values is switched, not limited.
const SWITCHED_LEVELS: usize = 16;
/// Sitting at an extreme counts from this share of the samples ...
const LIMIT_SHARE: f64 = 0.01;
/// ... and from so many in a row: noise touches its extreme once.
const LIMIT_RUN: usize = 5;
/// How many times the usual stay at other values that is.
const LONGER: f64 = 3.0;
/// An extreme below this share of the greatest magnitude is where a drive rests.
const AT_REST: f64 = 0.01;
/// Part of the range that a swing goes through.
const SWING: f64 = 0.1;
/// Speed below this share of the largest does not count as a direction.
const DIRECTION: f64 = 0.02;

/// How one signal looks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignalQuality {
    /// The signal's name.
    pub name: String,
    pub unit: String,
    /// Smallest value; NaN where there is none.
    pub min: f64,
    /// Largest value; NaN where there is none.
    pub max: f64,
    /// Mean of the values that are there.
    pub mean: f64,
    /// Where values are missing or not finite.
    pub missing: Stretches,
    /// Whether all values are the same.
    pub constant: bool,
    /// Extremes at which the signal sits.
    pub limits: Vec<Limit>,
    /// The grid that the values lie on.
    pub quantum: Option<Quantum>,
    /// How often the signal goes one way by a tenth of its range.
    pub swings: usize,
    /// Whether it takes both signs.
    pub both_signs: bool,
}

/// An extreme value at which a signal sits, as a saturated one does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    pub value: f64,
    /// Share of the samples there.
    pub share: f64,
    /// Longest stay, samples.
    pub longest: usize,
    /// Line (or row) at which that stay begins.
    pub at: u64,
}

impl SignalQuality {
    /// What deserves attention, a sentence each; `period_s` turns samples into seconds.
    pub(crate) fn warnings(&self, period_s: f64) -> Vec<String> {
        let SignalQuality { name, unit, .. } = self;
        let mut warnings = Vec::new();
        if self.constant {
            let value = rounded(self.min);
            warnings.push(format!(
                "{name} is constant at {value} {unit}: what only its changes show cannot be told"
            ));
            return warnings;
        }
        // A position at its extreme is where the drive stops.
        let limited = !matches!(name.as_str(), "theta" | "x" | "theta_load" | "x_load");
        for Limit { value, share, longest, at } in self.limits.iter().filter(|_| limited) {
            let (share, stay) = (100.0 * share, *longest as f64 * period_s);
            let value = rounded(*value);
            warnings.push(format!(
                "{name} sits at {value} {unit} for {share:.1} % of the samples, at most {stay:.3} s \
                 (from {at}): is it saturated?"
            ));
        }
        if let Some(quantum) = self.quantum.filter(|quantum| quantum.coarse) {
            let step = quantum.step;
            warnings.push(format!("{name} is quantised in steps of {step:.6e} {unit}"));
        }
        if matches!(name.as_str(), "u" | "reference") && self.swings < 2 {
            let swings =
                if self.swings == 1 { "once".to_owned() } else { format!("{} times", self.swings) };
            warnings.push(format!(
                "{name} swings {swings} only: fast and slow parts are hard to tell apart"
            ));
        }
        if matches!(name.as_str(), "omega" | "v") && !self.both_signs {
            warnings.push(format!(
                "{name} never reverses: what depends on the direction cannot be seen"
            ));
        }
        warnings
    }
}

/// The extremes at which a signal sits; places are samples, counted from 1, in the order of the
/// values.
pub fn limits(values: &[f64]) -> Vec<Limit> {
    inspect("", "", values, &Lines::rows("")).limits
}

/// Looks at the values of one signal; memory does not depend on their number.
pub(crate) fn inspect(name: &str, unit: &str, values: &[f64], lines: &Lines) -> SignalQuality {
    let mut missing = Stretches::default();
    let (mut min, mut max, mut sum) = (f64::NAN, f64::NAN, 0.0);
    let mut levels: Vec<f64> = Vec::new();
    for (k, value) in values.iter().copied().enumerate() {
        if !value.is_finite() {
            missing.add(k, lines.line(k));
            continue;
        }
        (min, max) = (min.min(value), max.max(value));
        sum += value;
        if levels.len() <= SWITCHED_LEVELS && !levels.contains(&value) {
            levels.push(value);
        }
    }
    let constant = min == max;
    let limits = if levels.len() > SWITCHED_LEVELS {
        // A drive at rest sits at zero, or at its sensor's offset, without being limited.
        let at_rest = AT_REST * min.abs().max(max.abs());
        let extremes = [min, max].into_iter().filter(|value| value.abs() > at_rest);
        let usual = usual_stay(values, min, max);
        let limits = extremes.filter_map(|extreme| limit(extreme, values, lines));
        limits.filter(|it| it.longest as f64 > LONGER * usual).collect()
    } else {
        Vec::new()
    };
    let least = DIRECTION * max.abs().max(min.abs());
    SignalQuality {
        name: name.to_owned(),
        unit: unit.to_owned(),
        min,
        max,
        mean: sum / (values.len() - missing.samples) as f64,
        missing,
        constant,
        limits,
        quantum: if constant { None } else { quantum(values, max - min) },
        swings: swings(values, min, max),
        both_signs: max > least && min < -least,
    }
}

/// Mean number of samples in a row of one value, the extremes left out: a slow signal in coarse
/// steps stays at each of them.
fn usual_stay(values: &[f64], min: f64, max: f64) -> f64 {
    let inner = |value: &f64| value.is_finite() && *value != min && *value != max;
    let samples = values.iter().filter(|value| inner(value)).count();
    let starts = values.windows(2).filter(|pair| inner(&pair[1]) && pair[0] != pair[1]).count();
    samples as f64 / starts.max(1) as f64
}

fn limit(extreme: f64, values: &[f64], lines: &Lines) -> Option<Limit> {
    let (mut count, mut run, mut longest, mut start) = (0, 0, 0, 0);
    for (k, value) in values.iter().enumerate() {
        run = if *value == extreme { run + 1 } else { 0 };
        count += usize::from(run > 0);
        if run > longest {
            (longest, start) = (run, k + 1 - run);
        }
    }
    let share = count as f64 / values.len() as f64;
    (share >= LIMIT_SHARE && longest >= LIMIT_RUN).then(|| Limit {
        value: extreme,
        share,
        longest,
        at: lines.line(start),
    })
}

/// Ways in one direction of at least [`SWING`] of the range.
fn swings(values: &[f64], min: f64, max: f64) -> usize {
    let least = SWING * (max - min);
    if least.is_nan() || least <= 0.0 {
        return 0;
    }
    // The ends of the way since the signal turned last, and where to it goes.
    let (mut low, mut high, mut side, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0, 0);
    for value in values.iter().copied().filter(|value| value.is_finite()) {
        (low, high) = (low.min(value), high.max(value));
        let rises = side != 1 && value - low >= least;
        if rises || (side != -1 && high - value >= least) {
            side = if rises { 1 } else { -1 };
            (low, high, count) = (value, value, count + 1);
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> SignalQuality {
        inspect("omega", "rad/s", values, &Lines::rows("a"))
    }

    fn sine(amplitude: f64) -> Vec<f64> {
        (0..2000).map(|k| amplitude * (0.01 * f64::from(k)).sin()).collect()
    }

    #[test]
    fn a_clipped_sine_is_limited_at_both_ends_and_a_whole_one_is_not() {
        let clipped: Vec<f64> = sine(12.0).iter().map(|value| value.clamp(-10.0, 9.5)).collect();
        let seen = of(&clipped);
        assert_eq!(seen.limits.iter().map(|it| it.value).collect::<Vec<_>>(), [-10.0, 9.5]);
        // A sine of 12 is beyond 9.5 for acos(9.5/12)/pi = 0.2096 of a whole period; the run
        // covers 3.18 periods, so the share is that within one part in ten.
        assert!((seen.limits[1].share - 0.2096).abs() < 0.03, "{:?}", seen.limits);
        assert_eq!(of(&sine(12.0)).limits, []);
    }

    #[test]
    fn switched_and_resting_signals_are_not_called_saturated() {
        let square: Vec<f64> =
            (0..1000).map(|k| if k / 50 % 2 == 0 { 5.0 } else { -5.0 }).collect();
        assert_eq!(of(&square).limits, []);
        assert_eq!(of(&square).swings, 19);
        // Once to where it swings, and then there.
        let switched = |k: i32| if k < 100 { 0.0 } else { 15.0 + f64::from((k / 100) % 2) * 3.0 };
        assert_eq!(of(&(0..2000).map(switched).collect::<Vec<_>>()).swings, 19);
        assert_eq!(of(&(0..100).map(f64::from).collect::<Vec<_>>()).swings, 1);
        let warming: Vec<f64> = (0..2000).map(|k| (f64::from(k) * 0.005).round()).collect();
        assert_eq!(of(&warming).limits, []);
        let resting: Vec<f64> = sine(1.0).iter().map(|value| value.max(0.0)).collect();
        assert_eq!(of(&resting).limits, []);
        let offset: Vec<f64> = resting.iter().map(|value| value.max(0.004)).collect();
        assert_eq!(of(&offset).limits, []);
        assert!(!of(&resting).both_signs && of(&sine(1.0)).both_signs);
    }

    #[test]
    fn holes_are_located_and_left_out_of_the_range() {
        let mut values = sine(1.0);
        values[10..15].fill(f64::NAN);
        values[100] = f64::INFINITY;
        let seen = of(&values);
        assert_eq!((seen.missing.samples, seen.missing.count), (6, 2));
        assert_eq!((seen.missing.listed[0].first, seen.missing.listed[0].last), (11, 15));
        assert!(seen.max <= 1.0 && seen.mean.is_finite());
    }

    #[test]
    fn constant_and_empty_signals() {
        let constant = of(&[3.0; 50]);
        assert!(constant.constant && constant.quantum.is_none() && constant.swings == 0);
        assert_eq!(constant.warnings(0.1).len(), 1);
        assert!(of(&[f64::NAN; 5]).min.is_nan());
    }
}
