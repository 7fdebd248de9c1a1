//! The grid of a segment and the place of every row on it.
//!
//! Row k of a segment stands at place s_k: `t_k = t_0 + h s_k + e_k`. Without lost samples s_k = k;
//! [`places`](super::places) tells how lost ones are found. They are believed where they explain
//! the stamps better than plain numbers of rows by more than chance does.

use super::line::Line;
use super::places::{Places, cost};
use super::step::grid;

/// Rounds in which step and places settle.
const ROUNDS: usize = 10;
/// Places of a segment at most for each of its rows.
const MOST_A_ROW: usize = 10;
/// Every hole in the places has to make the sum of squares smaller by so many times the mean square
/// that is left: chance does it by twice the logarithm of the number of rows.
const WORTH: f64 = 25.0;
/// Mean square that is left at least, in steps^2: no clock is better.
const EXACT: f64 = 1e-4;
/// Departure from its place, in steps, up to which a row is nearest to it.
const NEAR: f64 = 0.5;
/// Share of rows that may be stamped early by chance: two runs that were sorted into each other.
const EARLY: f64 = 0.05;
/// Rows at either end by which it is judged.
const END: usize = 8;
/// Departure from plain numbers of rows, in steps, below which nothing was lost.
const SURELY: f64 = 0.45;

/// The grid of a segment, and each row's place on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Slots {
    /// The grid.
    pub(super) line: Line,
    /// Place of each row, rising; none where row k stands at place k.
    pub(super) places: Option<Vec<usize>>,
    /// Largest departure of a stamp from its place, s.
    pub(super) largest_s: f64,
    /// Share of the rows that are nearer to their place than to any other.
    pub(super) near: f64,
    /// By how many steps the grid misses the stamps in a way that rows which came late cannot.
    pub(super) astray: f64,
}

impl Slots {
    /// Finds the grid of a segment; rows are in the order of their time, two at least.
    pub(super) fn of(time: &[f64]) -> Self {
        let plain = Self::at(time, Line::through_most(time, |k| k), None);
        // A lost sample leaves a step of a whole place between two rows.
        if plain.largest_s < SURELY * plain.line.step_s {
            return plain;
        }
        let mut places = Places::on(time, grid(time));
        for _ in 0..ROUNDS {
            let next = Places::on(time, places.line);
            if next == places {
                break;
            }
            places = next;
        }
        let by_rows: f64 = (0..time.len()).map(|k| cost(&plain.line, time[k], k as f64)).sum();
        let (holes, by_places) = (places.holes() as f64, places.misfit(time));
        let remainder = (by_places / time.len() as f64).max(EXACT);
        // Longer holes are gaps: so many places are no grid, and a damaged stamp asks for more yet.
        let sane = places.of_rows[time.len() - 1] < MOST_A_ROW * time.len();
        match sane && holes > 0.0 && by_rows - by_places > WORTH * holes * remainder {
            true => Self::at(time, places.line, Some(places.of_rows)),
            false => plain,
        }
    }

    fn at(time: &[f64], line: Line, places: Option<Vec<usize>>) -> Self {
        let mut slots = Self { line, places, largest_s: 0.0, near: 0.0, astray: 0.0 };
        let departures = || (0..time.len()).map(|k| slots.departure(time, k).abs());
        let largest_s = departures().fold(0.0, f64::max);
        let near = departures().filter(|it| *it <= NEAR * line.step_s).count() as f64;
        let steps = (0..time.len()).map(|k| slots.departure(time, k) / line.step_s).collect();
        (slots.largest_s, slots.near) = (largest_s, near / time.len() as f64);
        slots.astray = astray(steps);
        slots
    }

    /// The place of a row.
    pub(super) fn place(&self, row: usize) -> usize {
        self.places.as_ref().map_or(row, |places| places[row])
    }

    /// How much later than its place says a row is stamped, s.
    pub(super) fn departure(&self, time: &[f64], row: usize) -> f64 {
        self.line.departure(time[row], self.place(row))
    }
}

/// The most of what rows that came late do not explain among departures from a grid, in steps:
/// stamps before their samples, and lateness at the end that no later row makes up for.
fn astray(mut steps: Vec<f64>) -> f64 {
    let rows = steps.len();
    let least = |some: &[f64]| some.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |some: &[f64]| some.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let end = END.min(rows);
    let late = least(&steps[rows - end..]);
    let early = most(&steps[..end]).min(most(&steps[rows - end..]));
    let rank = (EARLY * rows as f64) as usize;
    let low = *steps.select_nth_unstable_by(rank, f64::total_cmp).1;
    late.max(-early).max(-low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::testing::jitter;

    #[test]
    fn jitter_moves_no_row() {
        let time: Vec<f64> = (0..5000).map(|k| 3.0 + 1e-3 * (k as f64 + 0.9 * jitter(k))).collect();
        let slots = Slots::of(&time);
        assert_eq!(slots.places, None);
        // A line through 5000 rows that are off by 0.26 steps rms tells its step to 2.5e-6.
        assert!((slots.line.step_s / 1e-3 - 1.0).abs() < 1e-5, "{}", slots.line.step_s);
        assert!((slots.largest_s - 0.45e-3).abs() < 2e-5, "{}", slots.largest_s);
    }

    #[test]
    fn lost_samples_leave_their_places_empty() {
        let there: Vec<usize> = (0..4000).filter(|k| (k * 7919) % 23 != 5).collect();
        for amplitude in [0.0, 0.2, 0.4] {
            let time: Vec<f64> =
                there.iter().map(|k| 0.01 * (*k as f64 + amplitude * jitter(*k))).collect();
            let slots = Slots::of(&time);
            assert_eq!(slots.places.as_deref(), Some(&there[..]), "{amplitude}");
            assert!((slots.line.step_s / 0.01 - 1.0).abs() < 1e-5, "{}", slots.line.step_s);
        }
    }

    #[test]
    fn coarse_and_late_stamps_keep_their_rows() {
        let coarse: Vec<f64> = (0..3000).map(|k| (k as f64 / 0.43).floor() * 1e-3).collect();
        let slots = Slots::of(&coarse);
        assert_eq!(slots.places, None);
        assert!((slots.line.step_s * 430.0 - 1.0).abs() < 1e-5, "{}", slots.line.step_s);
        let late: Vec<f64> =
            (0..600).map(|k| if (200..230).contains(&k) { 230.0 } else { k as f64 }).collect();
        let slots = Slots::of(&late);
        assert_eq!(slots.places, None);
        assert!(slots.astray < 0.5, "{slots:?}");
    }

    #[test]
    fn a_grid_that_the_stamps_do_not_follow_is_astray() {
        // Two steps that take turns, each for a while.
        let mut now = 0.0;
        let mut next = |k: usize| {
            now += if k % 80 < 40 { 0.0107 } else { 0.0200 };
            now
        };
        let turns: Vec<f64> = (0..600).map(&mut next).collect();
        assert!(Slots::of(&turns).astray > 3.0);
        // A slower end that no later row makes up for, and rows that came late together.
        assert!(astray((0..600).map(|k: i32| 0.3 * f64::from((k - 500).max(0))).collect()) > 3.0);
        let together = |k: i32| if (450..550).contains(&k) { f64::from(550 - k) } else { 0.0 };
        assert!(astray((0..600).map(together).collect()) < 0.5);
        let jittered: Vec<f64> = (0..600).map(|k| k as f64 + 0.9 * jitter(k)).collect();
        assert!(Slots::of(&jittered).astray < 0.5);
    }
}
