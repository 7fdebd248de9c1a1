//! Whether rows were sampled when their stamps say, or evenly and only stamped unevenly.
//!
//! With e_k the departure of a stamp from the grid and v_k the slope of a signal, a row that was
//! sampled at its stamp shows `y_k = Y(grid) + c v_k e_k` with c = 1, one that was sampled on the
//! grid c = 0. Second differences of y are regressed on those of v e. The slope is taken from
//! samples on either side, so that the noise of y is not on both sides of the equation; a second
//! slope, from other samples, is the instrument, or the noise of the first would draw c to 0.

use std::ops::Range;

use super::rows::Columns;
use super::slots::Slots;

/// Samples to either side over which a slope and its instrument are taken; beyond those of the
/// second difference, and of each other.
const REACH: usize = 3;
const FARTHER: usize = 6;
/// Standard error of c above which the signals do not tell.
const UNCERTAIN: f64 = 0.25;
/// Standard deviations beyond which a second difference is a step of the signal.
const CLIP: f64 = 4.0;
/// What the curvature of a signal within [`REACH`] leaves uncertain of its slope.
const CURVED: f64 = 0.1;
/// Rows that are looked at, at most.
const MOST_ROWS: usize = 200_000;

/// What the signals say of the stamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Instants {
    /// The coefficient c: 1 where rows were sampled at their stamps, 0 where evenly.
    pub(super) by_stamps: f64,
    /// Its standard error.
    pub(super) error: f64,
}

impl Instants {
    /// Whether rows were sampled at their stamps; none where the signals do not tell.
    pub(super) fn sampled_at_stamps(self) -> Option<bool> {
        (self.error < UNCERTAIN).then_some(self.by_stamps > 0.5)
    }

    /// Of the rows' times, and of the ranges and places of those that form segments; `kept` says
    /// which rows of the columns they are, where some were left out.
    pub(super) fn of(
        time: &[f64],
        columns: &Columns<'_>,
        kept: Option<&[usize]>,
        segments: &[(Range<usize>, &Slots)],
    ) -> Self {
        Self::together(columns.iter().filter_map(|values| {
            let value = |k: usize| values[kept.map_or(k, |kept| kept[k])];
            slope(&differences(time, value, segments))
        }))
    }

    /// The mean of several, each with its variance.
    pub(super) fn together(all: impl Iterator<Item = (f64, f64)>) -> Self {
        let (mut weight, mut weighted) = (0.0, 0.0);
        for (c, variance) in all {
            weight += 1.0 / variance;
            weighted += c / variance;
        }
        if weight == 0.0 {
            return Self { by_stamps: 0.0, error: f64::INFINITY };
        }
        Self { by_stamps: weighted / weight, error: weight.sqrt().recip() }
    }
}

/// Second differences at a row.
struct Row {
    /// Of v e.
    x: f64,
    /// Of the instrument.
    z: f64,
    y: f64,
}

fn differences(
    time: &[f64],
    value: impl Fn(usize) -> f64,
    segments: &[(Range<usize>, &Slots)],
) -> Vec<Row> {
    let mut found = Vec::new();
    for (rows, slots) in segments {
        let (t, y) = (&time[rows.clone()], |k: usize| value(rows.start + k));
        let even = |k: usize| slots.place(k + FARTHER + 1) - slots.place(k - FARTHER - 1);
        let last = t.len().saturating_sub(FARTHER + 1);
        for k in (FARTHER + 1..last).take(MOST_ROWS) {
            if even(k) != 2 * (FARTHER + 1) {
                continue;
            }
            let shifted = |k: usize, reach: usize| {
                // Over places: stamps of rows that came late all together do not differ.
                let slope =
                    (y(k + reach) - y(k - reach)) / (2.0 * reach as f64 * slots.line.step_s);
                slope * slots.departure(t, k)
            };
            let second = |of: &dyn Fn(usize) -> f64| of(k + 1) - 2.0 * of(k) + of(k - 1);
            let (x, z) = (second(&|k| shifted(k, REACH)), second(&|k| shifted(k, FARTHER)));
            let row = Row { x, z, y: second(&y) };
            if row.x.is_finite() && row.z.is_finite() && row.y.is_finite() {
                found.push(row);
            }
        }
    }
    found
}

/// The slope through the origin and its variance; nothing where nothing moves or where a signal
/// stands still between its steps, as an input does.
fn slope(rows: &[Row]) -> Option<(f64, f64)> {
    let rms = |some: &mut dyn Iterator<Item = f64>| {
        let (sum, n) = some.fold((0.0, 0usize), |(sum, n), y| (sum + y * y, n + 1));
        (sum / n.max(1) as f64).sqrt()
    };
    let mut most = f64::INFINITY;
    for _ in 0..3 {
        let mut kept = rows.iter().map(|row| row.y).filter(|y| y.abs() <= most);
        most = CLIP * rms(&mut kept);
    }
    let kept = || rows.iter().filter(|row| row.y.abs() <= most);
    let zx: f64 = kept().map(|row| row.z * row.x).sum();
    let zy: f64 = kept().map(|row| row.z * row.y).sum();
    let zz: f64 = kept().map(|row| row.z * row.z).sum();
    let still = rows.iter().filter(|row| row.y == 0.0).count();
    if 5 * still > rows.len() {
        return None;
    }
    let c = zy / zx;
    let remainder: f64 = kept().map(|row| (row.y - c * row.x).powi(2)).sum();
    // Neighbouring second differences are correlated: 1, -2/3, 1/6 a sample apart. The sum of the
    // squares' correlations, 1 + 2 (4/9 + 1/36), bounds what that adds to the variance.
    const CORRELATED: f64 = 1.94;
    let variance = CORRELATED * remainder / (kept().count().max(2) - 1) as f64 * zz / (zx * zx);
    (zz > 0.0 && variance.is_finite()).then_some((c, variance + CURVED * CURVED))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deterministic noise within one half.
    fn noise(k: usize, seed: f64) -> f64 {
        ((k as f64 + 1.0) * seed).sin().fract() * 0.5
    }

    fn stated(stamped: bool, noisy: f64) -> Instants {
        let jitter = |k: usize| 0.3e-3 * noise(k, 12.9898);
        let time: Vec<f64> = (0..4000).map(|k| 1e-3 * k as f64 + jitter(k)).collect();
        let at = |k: usize| if stamped { time[k] } else { 1e-3 * k as f64 };
        let values: Vec<f64> =
            (0..4000).map(|k| (25.0 * at(k)).sin() + noisy * noise(k, 78.233)).collect();
        let slots = Slots::of(&time);
        Instants::of(&time, &[&values], None, &[(0..4000, &slots)])
    }

    #[test]
    fn a_fast_signal_tells_and_a_noisy_one_does_not() {
        assert_eq!(stated(true, 1e-3).sampled_at_stamps(), Some(true));
        assert_eq!(stated(false, 1e-3).sampled_at_stamps(), Some(false));
        assert_eq!(stated(true, 10.0).sampled_at_stamps(), None);
    }

    #[test]
    fn what_does_not_move_does_not_tell() {
        let time: Vec<f64> = (0..100).map(|k| k as f64 + noise(k, 3.3)).collect();
        let slots = Slots::of(&time);
        let still = vec![2.0; 100];
        let found = Instants::of(&time, &[&still], None, &[(0..100, &slots)]);
        assert_eq!(found.sampled_at_stamps(), None);
    }
}
