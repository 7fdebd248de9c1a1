//! Places of rows on a grid of a known step, lost samples left empty.
//!
//! Where stamps jitter by less than half a step, every row belongs to the place nearest to it. Beyond
//! that a stamp can come late, never early by much, so a lost sample shows as a lead over the grid that
//! no later row gives back:
//!
//! ```text
//! s_k = k + round((m_k - m_0) / h),   m_k = min over j >= k of (t_j - h j)
//! ```
//!
//! Beside a hole that does not tell a row that is stamped late from one behind it: holes are moved
//! by a few rows to where rows depart least.

use super::line::Line;

/// Places of a segment at most.
const MOST_PLACES: f64 = 1e9;
/// Rows by which a hole is moved to where it fits best.
const REACH: usize = 4;
/// Squares of departures, in steps^2, that a hole has to explain where no more than these rows lie
/// before or behind it: a little less than one row without jitter.
const DOUBT: f64 = 0.9;

/// The place of each row, rising from 0, and the line through the stamps over them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Places {
    pub(super) of_rows: Vec<usize>,
    pub(super) line: Line,
}

impl Places {
    /// On about that grid.
    pub(super) fn on(time: &[f64], line: Line) -> Self {
        // Where nothing is off by half a step.
        if let Some(nearest) = nearest(time, line) {
            return Self::of(time, nearest);
        }
        let mut places = Self::of(time, by_lead(time, line.step_s));
        if places.holes() > 0 {
            places.move_holes(time);
            let first = places.of_rows[0];
            places = Self::of(time, places.of_rows.iter().map(|place| place - first).collect());
        }
        places
    }

    fn of(time: &[f64], of_rows: Vec<usize>) -> Self {
        let line = Line::through_most(time, |k| of_rows[k]);
        Self { of_rows, line }
    }

    /// How often samples are missing.
    pub(super) fn holes(&self) -> usize {
        (1..self.of_rows.len()).filter(|k| self.is_hole(*k)).count()
    }

    /// Whether samples are missing before a row.
    fn is_hole(&self, row: usize) -> bool {
        self.of_rows[row] > self.of_rows[row - 1] + 1
    }

    /// Sum of the squares of all departures, in steps.
    pub(super) fn misfit(&self, time: &[f64]) -> f64 {
        (0..time.len()).map(|k| cost(&self.line, time[k], self.of_rows[k] as f64)).sum()
    }

    fn move_holes(&mut self, time: &[f64]) {
        for k in 1..time.len() {
            if !self.is_hole(k) {
                continue;
            }
            let end = time.len().min(k + REACH);
            let later = (k..end).take_while(|row| *row == k || !self.is_hole(*row));
            let later = self.best_move(time, later, -1.0);
            let first = k.saturating_sub(REACH);
            let sooner = (first..k).rev();
            let sooner = sooner.take_while(|row| *row + 1 == k || !self.is_hole(row + 1));
            let sooner = self.best_move(time, sooner, 1.0);
            match later.0 < sooner.0 {
                true => self.of_rows[k..k + later.1].iter_mut().for_each(|place| *place -= 1),
                false => self.of_rows[k - sooner.1..k].iter_mut().for_each(|place| *place += 1),
            }
        }
    }

    /// What moving some of these rows, from the first on, changes in the misfit at best, and how
    /// many rows those are.
    fn best_move(&self, time: &[f64], rows: impl Iterator<Item = usize>, by: f64) -> (f64, usize) {
        let (mut change, mut best) = (0.0, (0.0, 0));
        for (count, row) in rows.enumerate() {
            let (stamp, place) = (time[row], self.of_rows[row] as f64);
            change += cost(&self.line, stamp, place + by) - cost(&self.line, stamp, place);
            // At an end the hole is gone.
            let doubt = if row == 0 || row + 1 == time.len() { DOUBT } else { 0.0 };
            if change - doubt < best.0 {
                best = (change - doubt, count + 1);
            }
        }
        best
    }
}

/// Square of a departure, in steps. Rows that came late all together count as one step each: no
/// grid explains them.
pub(super) fn cost(line: &Line, time: f64, place: f64) -> f64 {
    ((time - line.first_s) / line.step_s - place).powi(2).min(1.0)
}

/// The place nearest to each stamp, from 0 on; nothing where two rows have the same.
fn nearest(time: &[f64], line: Line) -> Option<Vec<usize>> {
    let place = |t: &f64| ((t - line.first_s) / line.step_s).round();
    let first = place(&time[0]);
    let places: Vec<f64> = time.iter().map(|t| (place(t) - first).min(MOST_PLACES)).collect();
    let rising = places.windows(2).all(|pair| pair[0] < pair[1]);
    rising.then(|| places.into_iter().map(|place| place as usize).collect())
}

/// Places by the least lead over the grid among this row and all later ones.
fn by_lead(time: &[f64], step: f64) -> Vec<usize> {
    let lead = |k: usize| (time[k] - time[0]) / step - k as f64;
    let mut least = vec![0.0; time.len()];
    let mut ahead = f64::INFINITY;
    for k in (0..time.len()).rev() {
        ahead = lead(k).min(ahead);
        least[k] = ahead;
    }
    let skipped = |k: usize| (least[k] - least[0]).round().min(MOST_PLACES) as usize;
    (0..time.len()).map(|k| k + skipped(k)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hole_lies_where_rows_depart_least() {
        // Sample 50 is lost; the row before it is stamped late, and so is the last.
        let mut time: Vec<f64> = (0..100).filter(|k| *k != 50).map(f64::from).collect();
        time[49] += 0.4;
        time[10] -= 0.3;
        time[98] += 0.45;
        let found = Places::on(&time, Line { step_s: 1.0, first_s: 0.0 });
        let expected: Vec<usize> = (0..100).filter(|k| *k != 50).collect();
        assert_eq!(found.of_rows, expected);
        assert!((found.line.step_s - 1.0).abs() < 1e-3 && found.holes() == 1, "{found:?}");
    }
}
