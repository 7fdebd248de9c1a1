//! Stamps of a clock that ticks more slowly than rows come: rows of one stamp are spread over its
//! tick.
//!
//! The first row after a tick was sampled within one step of it, so that the times of first rows
//! are known to a step, however long a tick is; the others lie evenly between. Before a gap the
//! rows of a tick follow it; behind a gap they lead to the next one.

use std::ops::Range;

use super::line::median;
use super::rows::COARSE;
use crate::clock::parted;

/// Ticks so many usual ones apart have a gap between them.
const APART: f64 = 1.5;
/// So many times the usual number of rows under one stamp, and two more, are no tick: the logger
/// stood still.
const STOOD_STILL: f64 = 3.0;
/// Ticks that make a clock.
const ENOUGH: usize = 3;

/// The time of every row, and its stamp.
pub(super) struct Stamped {
    /// Where the row lies within its tick, s.
    pub(super) time: Vec<f64>,
    /// The stamps, s, where some were spread.
    stamps: Option<Vec<f64>>,
    /// How far a row was moved, at most, s.
    pub(super) shift_s: f64,
}

impl Stamped {
    /// Of stamps; `runs` are the rows at which a run begins.
    pub(super) fn of(stamps: Vec<f64>, runs: &[usize]) -> Self {
        let Some(time) = spread(&stamps, runs) else {
            return Self { time: stamps, stamps: None, shift_s: 0.0 };
        };
        let shifts = stamps.iter().zip(&time).map(|(stamp, time)| (stamp - time).abs());
        let shift_s = shifts.fold(0.0, f64::max);
        Self { time, stamps: Some(stamps), shift_s }
    }

    /// Whether stamps were coarser than the sampling.
    pub(super) fn is_spread(&self) -> bool {
        self.stamps.is_some()
    }

    /// What the file says of a row, s.
    pub(super) fn stamp(&self, row: usize) -> f64 {
        self.stamps.as_ref().map_or(self.time[row], |stamps| stamps[row])
    }

    /// Whether some of these rows were moved.
    pub(super) fn is_spread_in(&self, rows: &Range<usize>) -> bool {
        let moved = |stamps: &Vec<f64>| stamps[rows.clone()] != self.time[rows.clone()];
        self.stamps.as_ref().is_some_and(moved)
    }
}

/// The times of all rows, those of coarse stamps spread; nothing where no run has such stamps.
/// `runs` are the rows at which a run begins.
fn spread(time: &[f64], runs: &[usize]) -> Option<Vec<f64>> {
    let mut all: Option<Vec<f64>> = None;
    for run in parted(runs.iter().copied(), time.len()) {
        if let Some(ticks) = Ticks::of(&time[run.clone()]) {
            let all = all.get_or_insert_with(|| time.to_vec());
            for tick in 0..ticks.rows.len() {
                let first = run.start + ticks.rows[tick];
                let times = ticks.times(tick);
                all[first..first + times.len()].copy_from_slice(&times);
            }
        }
    }
    all
}

/// The stamps of a run, each once.
struct Ticks {
    stamps: Vec<f64>,
    /// The first row of every stamp.
    rows: Vec<usize>,
    /// How many rows share it.
    shared: Vec<usize>,
    /// The usual time between stamps, s, and between rows.
    usual_s: f64,
    step_s: f64,
}

impl Ticks {
    /// Of a run whose stamps are coarser than its sampling.
    fn of(time: &[f64]) -> Option<Self> {
        let repeats = time.windows(2).filter(|pair| pair[0] == pair[1]).count();
        if repeats as f64 <= COARSE * time.len() as f64 {
            return None;
        }
        let rows: Vec<usize> =
            (0..time.len()).filter(|k| *k == 0 || time[*k] != time[k - 1]).collect();
        let ends = rows.iter().skip(1).copied().chain([time.len()]);
        let shared: Vec<usize> = rows.iter().zip(ends).map(|(from, to)| to - from).collect();
        let most = STOOD_STILL * time.len() as f64 / rows.len() as f64 + 2.0;
        let ticked: usize =
            shared.iter().filter(|rows| **rows as f64 <= most).map(|rows| rows - 1).sum();
        if ticked as f64 <= COARSE * time.len() as f64 || rows.len() < ENOUGH {
            return None;
        }
        let stamps: Vec<f64> = rows.iter().map(|k| time[*k]).collect();
        let steps = || stamps.windows(2).map(|pair| pair[1] - pair[0]);
        let usual_s = median(steps().collect());
        let step_s = median(steps().zip(&shared).map(|(tick, rows)| tick / *rows as f64).collect());
        Some(Self { stamps, rows, shared, usual_s, step_s })
    }

    /// From a tick to the next, where none is missing between.
    fn length(&self, tick: usize) -> Option<f64> {
        let length = self.stamps.get(tick + 1)? - self.stamps[tick];
        let most = self.usual_s.max(self.step_s * self.shared[tick] as f64);
        (length <= APART * most).then_some(length)
    }

    /// Between the rows of a tick, where none is missing.
    fn step(&self, tick: usize) -> Option<f64> {
        Some(self.length(tick)? / self.shared[tick] as f64)
    }

    /// Times of the rows of a tick.
    fn times(&self, tick: usize) -> Vec<f64> {
        let (stamp, rows) = (self.stamps[tick], self.shared[tick]);
        let before = tick.checked_sub(1).and_then(|before| self.step(before));
        let from = |first: f64, step: f64| (0..rows).map(|k| first + k as f64 * step).collect();
        match (before, self.length(tick)) {
            (Some(_), Some(length)) => from(stamp, length / rows as f64),
            (None, Some(length)) => {
                let step = self.step(tick + 1).unwrap_or(self.step_s).min(length / rows as f64);
                from(stamp + length - step * rows as f64, step)
            }
            (before, None) => {
                let step = before.unwrap_or(self.step_s).min(self.usual_s / rows as f64);
                from(stamp, step)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Departure from the true instants, in steps, of stamps that are cut off to whole ticks.
    fn off(instants: &[f64], tick: f64, step: f64) -> f64 {
        let stamps: Vec<f64> = instants.iter().map(|t| (t / tick + 1e-9).floor() * tick).collect();
        let found = spread(&stamps, &[]).unwrap();
        let off = |(a, b): (&f64, &f64)| (a - b).abs() / step;
        found.iter().zip(instants).map(off).fold(0.0, f64::max)
    }

    #[test]
    fn rows_are_known_to_a_step_with_ticks_of_any_length() {
        for (step, tick) in [(1e-3, 1e-2), (1.0 / 62.0, 0.1), (1.0 / 62.0, 1.0), (7e-4, 1e-3)] {
            let even: Vec<f64> = (0..3017).map(|k| (f64::from(k) + 0.3) * step).collect();
            let found = off(&even, tick, step);
            assert!(found <= 1.0, "{step} {tick}: {found}");
        }
    }

    #[test]
    fn ticks_on_both_sides_of_a_gap_are_not_whole() {
        let gap = |k: i32| f64::from(k) * 1e-3 + if k < 1234 { 0.0 } else { 0.0567 };
        let found = off(&(0..3003).map(gap).collect::<Vec<_>>(), 0.01, 1e-3);
        assert!(found <= 1.0, "{found}");
    }

    #[test]
    fn what_does_not_tick_is_left_alone() {
        let even: Vec<f64> = (0..300).map(f64::from).collect();
        assert_eq!(spread(&even, &[]), None);
        // A logger that stands still twice, for a third of the rows.
        let still = |k: i32| match k {
            50..100 => 99.0,
            200..250 => 249.0,
            _ => f64::from(k),
        };
        assert_eq!(spread(&(0..300).map(still).collect::<Vec<_>>(), &[]), None);
        assert_eq!(spread(&[2.0; 50], &[]), None);
    }
}
