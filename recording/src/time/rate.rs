//! The sampling time of one segment, that of all, and how rows get on its grid.

use std::ops::Range;

use super::rows::COARSE;
use super::slots::Slots;
use super::uniform::{shortest, uniform};

/// Sampling times that agree to this share are one.
const ONE_RATE: f64 = 0.01;
/// A sampling time is rounded to where it is this part of a sample off at the end of the longest
/// segment.
const ROUNDED: f64 = 0.1;
/// Departure from its place, in steps, up to which a row counts for it whatever its stamp says.
const NEAR: f64 = 0.5;
/// Share of rows near their places from which on they are samples, where the signals do not tell.
const MOST: f64 = 0.7;
/// Steps by which a grid may miss its stamps in a way that rows which came late cannot: where only
/// the stamps speak for it, and where the signals do or stamps are coarse.
const ASTRAY: f64 = 1.0;
const ASTRAY_WITH_SIGNALS: f64 = 3.0;
/// Steps by which segments may differ in length from the common sampling time for their jitter.
const MOST_DRIFT: f64 = 1.0;

/// How rows get to samples.
pub(super) enum Way {
    /// Row by row, each at its place.
    Places(Option<Vec<usize>>),
    /// Between rows, by their stamps.
    Stamps,
}

/// The clock of one segment.
pub(super) struct Clock {
    pub(super) rows: Range<usize>,
    /// Its sampling time, s.
    period_s: f64,
    /// Largest departure of a stamp from its place, in steps.
    pub(super) jitter: f64,
    /// Whether its stamps are coarser than the sampling: they say nothing of a single row.
    pub(super) coarse: bool,
    /// Its grid; none where it is uniform by itself.
    pub(super) slots: Option<Slots>,
}

impl Clock {
    /// Of the rows of one segment; whether they were spread over ticks.
    pub(super) fn of(time: &[f64], ticks: bool, rows: Range<usize>) -> Self {
        let stamped = &time[rows.clone()];
        let repeats = stamped.windows(2).filter(|pair| pair[0] == pair[1]).count();
        let coarse = ticks || repeats as f64 > COARSE * stamped.len() as f64;
        if let Some(found) = uniform(stamped) {
            let (period_s, jitter) = (found.period_s, found.jitter);
            return Self { rows, period_s, jitter, coarse, slots: None };
        }
        let slots = Slots::of(stamped);
        let (period_s, jitter) = (slots.line.step_s, slots.largest_s / slots.line.step_s);
        Self { rows, period_s, jitter, coarse, slots: Some(slots) }
    }

    /// Largest departure of a stamp from its place, s.
    pub(super) fn largest_s(&self) -> f64 {
        self.slots.as_ref().map_or(0.0, |slots| slots.largest_s)
    }

    /// Places of the clock's grid from first to last.
    fn span(&self) -> usize {
        let last = self.rows.len() - 1;
        self.slots.as_ref().map_or(last, |slots| slots.place(last))
    }

    /// Whether its rows were sampled evenly, whatever their stamps say; `by_stamps` is what the
    /// signals say.
    fn is_even(&self, by_stamps: Option<bool>) -> bool {
        let Some(slots) = &self.slots else { return true };
        // A grid that the stamps do not follow is none, whatever else speaks for it.
        let stated = self.coarse || by_stamps.is_some();
        if slots.astray > if stated { ASTRAY_WITH_SIGNALS } else { ASTRAY } {
            return false;
        }
        // Most rows at their places: the others came late together.
        self.coarse || !by_stamps.unwrap_or(slots.near < MOST)
    }

    /// When its first sample was taken, s: at the first stamp, unless that row came late and the
    /// others say when it was due.
    pub(super) fn start_s(&self, time: &[f64], way: &Way) -> f64 {
        let late_s = |slots: &Slots| {
            let departure_s = slots.departure(time, 0);
            let is_due = matches!(way, Way::Places(_)) && !self.coarse;
            if is_due && departure_s > NEAR * slots.line.step_s { departure_s } else { 0.0 }
        };
        time[0] - self.slots.as_ref().map_or(0.0, late_s)
    }

    /// Whether its rows are no samples of that sampling time.
    fn is_other(&self, period_s: f64) -> bool {
        let off = (self.period_s - period_s).abs() * self.span() as f64 / period_s;
        // Over few rows jitter alone makes the sampling time a little other.
        off > NEAR.max(self.jitter.min(MOST_DRIFT))
    }

    /// When its rows were sampled, where that differs from their stamps and matters: between rows.
    pub(super) fn even_times(&self, period_s: f64, by_stamps: Option<bool>) -> Option<Vec<f64>> {
        let slots = self.slots.as_ref().filter(|_| self.is_other(period_s))?;
        let at = |row: usize| slots.line.first_s + slots.line.step_s * slots.place(row) as f64;
        self.is_even(by_stamps).then(|| (0..self.rows.len()).map(at).collect())
    }

    /// How its rows get on a grid of that sampling time.
    pub(super) fn way(&self, period_s: f64, by_stamps: Option<bool>) -> Way {
        match &self.slots {
            _ if self.is_other(period_s) || !self.is_even(by_stamps) => Way::Stamps,
            None => Way::Places(None),
            Some(slots) => Way::Places(slots.places.clone()),
        }
    }
}

/// The sampling time of the segment with most rows, and of those that agree with it.
pub(super) fn common_period(clocks: &[Clock]) -> f64 {
    let Some(longest) = clocks.iter().max_by_key(|clock| (clock.rows.len(), clock.rows.start))
    else {
        return f64::NAN;
    };
    if longest.slots.is_none() {
        return longest.period_s;
    }
    let alike = |clock: &&Clock| {
        (clock.period_s / longest.period_s - 1.0).abs() < ONE_RATE && clock.span() > 0
    };
    let (mut sum, mut places) = (0.0, 0);
    for clock in clocks.iter().filter(alike) {
        sum += clock.period_s * clock.span() as f64;
        places += clock.span();
    }
    let mean = sum / places as f64;
    shortest(mean, ROUNDED * mean / longest.span().max(1) as f64)
}
