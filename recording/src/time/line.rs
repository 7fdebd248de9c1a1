//! Straight lines through stamps over the places of their rows.

/// Rounds in which a line settles.
const ROUNDS: usize = 10;
/// Rows that a median is taken of, at most.
const MOST_ROWS: usize = 20_000;

/// The time of every place: `first_s + step_s * place`, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) step_s: f64,
    pub(super) first_s: f64,
}

impl Line {
    /// The line through all rows.
    pub(super) fn through_all(time: &[f64], place: impl Fn(usize) -> usize) -> Self {
        Self::through(time, &(0..time.len()).collect::<Vec<_>>(), place)
    }

    /// The line through the rows within a step of it: those that came late by more do not pull at
    /// it, unless they are most. Two rows at least.
    pub(super) fn through_most(time: &[f64], place: impl Fn(usize) -> usize + Copy) -> Self {
        // The median of the slopes over half the rows, then of what is left.
        let half = time.len() / 2;
        let some = |rows: usize| (0..rows).step_by(rows.div_ceil(MOST_ROWS));
        let slope = |k: usize| (time[k + half] - time[k]) / (place(k + half) - place(k)) as f64;
        let step_s = median(some(time.len() - half).map(slope).collect());
        let remainder = |k: usize| time[k] - step_s * place(k) as f64;
        let mut line = Self { step_s, first_s: median(some(time.len()).map(remainder).collect()) };
        for _ in 0..ROUNDS {
            let near = |k: &usize| line.departure(time[*k], place(*k)).abs() <= line.step_s;
            let near: Vec<usize> = (0..time.len()).filter(near).collect();
            if 2 * near.len() <= time.len() {
                return Self::through_all(time, place);
            }
            let next = Self::through(time, &near, place);
            if next == line {
                break;
            }
            line = next;
        }
        line
    }

    /// The line through some of the rows.
    fn through(time: &[f64], rows: &[usize], place: impl Fn(usize) -> usize) -> Self {
        let place = |k: usize| place(k) as f64;
        let n = rows.len() as f64;
        // Around the middle, so that nothing is lost where time is that of an epoch.
        let middle = rows.iter().map(|k| place(*k)).sum::<f64>() / n;
        let mean = rows.iter().map(|k| time[*k] - time[0]).sum::<f64>() / n;
        let (mut cross, mut square) = (0.0, 0.0);
        for &k in rows {
            let from = place(k) - middle;
            cross += from * (time[k] - time[0] - mean);
            square += from * from;
        }
        let step_s = cross / square;
        Self { step_s, first_s: time[0] + mean - step_s * middle }
    }

    /// How much later than its place a row is stamped, s.
    pub(super) fn departure(&self, time: f64, place: usize) -> f64 {
        time - (self.first_s + self.step_s * place as f64)
    }
}

/// The upper median of at least one value.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_came_late_do_not_pull() {
        let late = |k: usize| if (700..950).contains(&k) { 950.0 } else { k as f64 };
        let time: Vec<f64> = (0..1000).map(|k| 5.0 + 2.0 * late(k)).collect();
        let line = Line::through_most(&time, |k| k);
        assert!((line.step_s - 2.0).abs() < 1e-3, "{line:?}");
        assert!((line.first_s - 5.0).abs() < 1.0, "{line:?}");
        let all = Line::through_all(&time, |k| k);
        assert!(all.step_s > 2.1, "{all:?}");
    }

    #[test]
    fn an_epoch_loses_nothing() {
        let time: Vec<f64> = (0..100).map(|k| 1.7e9 + f64::from(k)).collect();
        assert_eq!(Line::through_all(&time, |k| k).step_s, 1.0);
    }
}
