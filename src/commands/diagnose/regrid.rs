//! Rows of any rate on a uniform grid, as they come: what `Recording::resample` does for a whole one.
//!
//! Values lie on the straight line between their neighbours; an input that is held from row to row
//! keeps its mean over each sample, so that its sample is known when the next is due.

use std::collections::VecDeque;

use drivescope_monitor::BRIDGED;

use super::pace::{Arrival, Backwards};

/// Rounding of times, in sampling times.
const ROUNDING: f64 = 1e-9;
/// Share by which the usual step follows the last one.
const FOLLOWED: f64 = 0.1;

/// Rows on their way onto a grid.
#[derive(Debug, Clone)]
pub(super) struct Regrid {
    period_s: f64,
    held: Vec<bool>,
    /// Rows from the one before the next grid point on.
    rows: VecDeque<(f64, Vec<f64>)>,
    /// Beginning of the segment, and samples of it that were given.
    start: f64,
    given: usize,
    /// Usual step of the rows, s.
    step: Option<f64>,
    /// A segment begins with the rows that are here.
    anew: bool,
    backwards: Backwards,
}

impl Regrid {
    pub(super) fn new(period_s: f64, held: Vec<bool>) -> Self {
        Self {
            period_s,
            held,
            rows: VecDeque::new(),
            start: 0.0,
            given: 0,
            step: None,
            anew: false,
            backwards: Backwards::default(),
        }
    }

    fn begin(&mut self, time: f64, values: &[f64]) {
        self.anew = self.step.is_some();
        self.rows.clear();
        self.rows.push_back((time, values.to_vec()));
        (self.start, self.given, self.backwards) = (time, 0, Backwards::default());
    }

    /// Takes a row; what is wrong with its time.
    pub(super) fn push(&mut self, time: f64, values: &[f64]) -> Option<Arrival> {
        let Some((last, _)) = self.rows.back() else {
            self.begin(time, values);
            return None;
        };
        let step = time - last;
        if let Some(back) = self.backwards.arrives(time, *last) {
            if matches!(back, Arrival::SetBack { .. }) {
                self.begin(time, values);
            }
            return Some(back);
        }
        let usual = self.step.unwrap_or(step);
        if step > (BRIDGED as f64 + 1.5) * usual.max(self.period_s) {
            let lost = (step / self.period_s) as usize;
            self.begin(time, values);
            return Some(Arrival::Row { lost, time });
        }
        self.step = Some(usual + FOLLOWED * (step - usual));
        self.rows.push_back((time, values.to_vec()));
        None
    }

    /// The next sample: its time, s, values, and as many lost rows before it as begin a segment.
    pub(super) fn next_row(&mut self) -> Option<(f64, Vec<f64>, usize)> {
        let at = self.start + self.given as f64 * self.period_s;
        let next = self.start + (self.given + 1) as f64 * self.period_s;
        let slack = ROUNDING * self.period_s;
        let needed = if self.held.contains(&true) { next - slack } else { at };
        let (end, _) = self.rows.back()?;
        if *end < needed {
            return None;
        }
        // The last row at or before the grid point stays: the others are done with.
        while self.rows.len() > 1 && self.rows[1].0 <= at {
            self.rows.pop_front();
        }
        let (before, left) = &self.rows[0];
        let share = self.rows.get(1).map_or(0.0, |(after, _)| (at - before) / (after - before));
        let values = self.held.iter().enumerate().map(|(k, held)| {
            if *held {
                return self.mean(k, (at, next), slack);
            }
            match self.rows.get(1) {
                Some((_, right)) if share > 0.0 => left[k] + share * (right[k] - left[k]),
                _ => left[k],
            }
        });
        let values = values.collect();
        self.given += 1;
        let lost = if std::mem::take(&mut self.anew) { usize::MAX } else { 0 };
        Some((at, values, lost))
    }

    /// Mean of a held value over a sample.
    fn mean(&self, k: usize, (from, to): (f64, f64), slack: f64) -> f64 {
        let ends = |row: usize| self.rows.get(row + 1).map_or(f64::INFINITY, |next| next.0);
        let mut row = 0;
        while ends(row) <= from + slack {
            row += 1;
        }
        if ends(row) >= to - slack {
            return self.rows[row].1[k];
        }
        let (mut at, mut sum) = (from, 0.0);
        while at < to {
            let until = ends(row).min(to);
            sum += self.rows[row].1[k] * (until - at);
            (at, row) = (until, row + 1);
        }
        sum / (at - from)
    }
}

#[cfg(test)]
mod tests {
    use drivescope_recording::{Recording, Signal};

    use super::*;

    /// A stream of rows gives what the whole recording does.
    #[test]
    fn a_stream_is_resampled_as_a_recording_is() {
        let (step, period) = (0.003, 0.005);
        let signal = |name: &str, of: fn(f64) -> f64| Signal {
            name: name.to_owned(),
            unit: "V".to_owned(),
            values: (0..400).map(|k| of(f64::from(k))).collect(),
        };
        let signals = vec![signal("u", |k| (0.7 * k).sin()), signal("T", |k| (0.1 * k).cos())];
        let recording = Recording::new("r", 2.0, step, signals);
        let whole = recording.resample(period).expect("it can be");
        let mut regrid = Regrid::new(period, vec![true, false]);
        let mut rows = Vec::new();
        for k in 0..recording.len() {
            let values: Vec<f64> = recording.signals.iter().map(|it| it.values[k]).collect();
            assert_eq!(regrid.push(recording.time(k), &values), None);
            rows.extend(std::iter::from_fn(|| regrid.next_row()));
        }
        assert!(rows.len() + 1 >= whole.len(), "{} {}", rows.len(), whole.len());
        for (k, (time, values, lost)) in rows.iter().enumerate() {
            assert_eq!((*time, *lost), (whole.time(k), 0));
            for (value, signal) in values.iter().zip(&whole.signals) {
                assert!((value - signal.values[k]).abs() < 1e-12, "{k} {}", signal.name);
            }
        }
    }

    #[test]
    fn a_gap_begins_a_segment_and_late_rows_are_passed_over() {
        let mut regrid = Regrid::new(0.01, vec![false]);
        let mut taken = Vec::new();
        let times = [0.0, 0.01, 0.02, 0.02, 0.015, 0.03, 1.0, 1.01];
        let stated: Vec<_> = times
            .iter()
            .map(|time| {
                let stated = regrid.push(*time, &[*time]);
                taken.extend(std::iter::from_fn(|| regrid.next_row()));
                stated
            })
            .collect();
        assert_eq!((stated[3], stated[4]), (Some(Arrival::Repeated), Some(Arrival::Late)));
        assert!(matches!(stated[6], Some(Arrival::Row { lost: 97, .. })), "{stated:?}");
        let lost: Vec<usize> = taken.iter().map(|row| row.2).collect();
        assert_eq!(lost, [0, 0, 0, 0, usize::MAX, 0]);
    }
}
