//! Rows that can be used, in the order of their time.

use crate::error::Error;
use crate::place::Lines;
use crate::stretches::Stretches;

/// A row that comes up to so many rows too late was sent in disorder; time that goes back farther
/// begins a new run.
const DISORDER: usize = 20;

/// Rows after which a stamp at or before the first one begins a new run.
const SHORTEST_RUN: usize = 3;

/// Share of rows with the time of the row before from which on stamps are coarser than the sampling.
pub(super) const COARSE: f64 = 0.2;

/// The values of a file beside its time: one list a column, of equal length.
pub(crate) type Columns<'a> = [&'a [f64]];

/// Rows in order, and what was done to get there.
pub(super) struct Rows {
    /// Which rows of the file, in order; none where all are there as they stand.
    pub(super) kept: Option<Vec<usize>>,
    /// Positions among the kept rows at which a run begins, the first left out: time jumps back
    /// there, or a column says so.
    pub(super) runs: Vec<usize>,
    /// Rows without a time.
    pub(super) unstamped: Stretches,
    /// Rows that repeat the one before, time and values.
    pub(super) repeated: Stretches,
    /// Rows that stood in disorder.
    pub(super) disordered: usize,
}

/// Finds the rows that can be used; `run` numbers the runs.
///
/// # Errors
/// [`Error::TimeNotFinite`] where most rows have no time, [`Error::TimeBackwards`] where time runs
/// back from row to row.
pub(super) fn rows(
    time: &[f64],
    columns: &Columns<'_>,
    run: Option<&[f64]>,
    lines: &Lines,
) -> Result<Rows, Error> {
    let mut rows = Rows {
        kept: None,
        runs: Vec::new(),
        unstamped: Stretches::default(),
        repeated: Stretches::default(),
        disordered: 0,
    };
    let unstamped = || (0..time.len()).filter(|k| !time[*k].is_finite());
    for k in unstamped() {
        rows.unstamped.add(k, lines.line(k));
    }
    if 2 * rows.unstamped.samples > time.len() {
        let first = unstamped().next().unwrap_or(0);
        return Err(Error::TimeNotFinite { place: lines.place(first) });
    }
    let rising = time.windows(2).all(|pair| pair[0] < pair[1]);
    if rising && rows.unstamped.is_empty() {
        rows.runs = run.map(|run| changes(run.iter())).unwrap_or_default();
        return Ok(rows);
    }
    let mut kept: Vec<usize> = (0..time.len()).filter(|k| time[*k].is_finite()).collect();
    backwards_throughout(time, &kept, lines)?;
    rows.runs = jumps_back(time, &kept);
    if let Some(run) = run {
        rows.runs.extend(changes(kept.iter().map(|k| &run[*k])));
        rows.runs.sort_unstable();
        rows.runs.dedup();
    }
    let ends = rows.runs.iter().copied().chain([kept.len()]).collect::<Vec<_>>();
    let mut from = 0;
    for end in ends {
        let run = &mut kept[from..end];
        rows.disordered += run.windows(2).filter(|pair| time[pair[1]] < time[pair[0]]).count();
        // Stable: rows of one time stay as they came.
        run.sort_by(|a, b| time[*a].total_cmp(&time[*b]));
        from = end;
    }
    let same = |a: usize, b: usize| {
        let equal = |column: &&[f64]| column[a].to_bits() == column[b].to_bits();
        time[a] == time[b] && columns.iter().all(equal)
    };
    let twice =
        |k: usize| k > 0 && rows.runs.binary_search(&k).is_err() && same(kept[k - 1], kept[k]);
    // Stamps coarser than the sampling repeat all the time, and so do the values of a shaft at rest.
    let still = kept.windows(2).filter(|pair| time[pair[0]] == time[pair[1]]).count();
    let coarse = still as f64 > COARSE * kept.len() as f64;
    let repeats: Vec<usize> = (0..kept.len()).filter(|k| !coarse && twice(*k)).collect();
    for k in &repeats {
        rows.repeated.add(kept[*k], lines.line(kept[*k]));
    }
    rows.runs.iter_mut().for_each(|begin| *begin -= repeats.partition_point(|k| k < begin));
    let mut next = repeats.iter().peekable();
    let mut position = 0;
    kept.retain(|_| {
        let repeats = next.next_if(|k| **k == position).is_some();
        position += 1;
        !repeats
    });
    rows.kept = Some(kept);
    Ok(rows)
}

fn backwards_throughout(time: &[f64], kept: &[usize], lines: &Lines) -> Result<(), Error> {
    let mut back = kept.windows(2).filter(|pair| time[pair[1]] < time[pair[0]]);
    let (first, count) = (back.clone().next(), back.by_ref().count());
    match first {
        Some(pair) if 2 * count > kept.len() - 1 => Err(Error::TimeBackwards {
            place: lines.place(pair[1]),
            from_s: time[pair[0]],
            to_s: time[pair[1]],
        }),
        _ => Ok(()),
    }
}

/// Positions at which time falls behind all of the last rows of the run, or back to its beginning.
fn jumps_back(time: &[f64], kept: &[usize]) -> Vec<usize> {
    let Some(first) = kept.first() else { return Vec::new() };
    let (mut begin, mut latest) = ((0, time[*first]), time[*first]);
    let mut jumps = Vec::new();
    for (position, row) in kept.iter().enumerate() {
        let back = time[*row] < latest;
        let again = time[*row] <= begin.1 && position - begin.0 >= SHORTEST_RUN;
        let behind = |rows: &[usize]| rows.iter().all(|earlier| time[*earlier] > time[*row]);
        let far = || position - begin.0 >= DISORDER && behind(&kept[position - DISORDER..position]);
        if back && (again || far()) {
            jumps.push(position);
            (begin, latest) = ((position, time[*row]), time[*row]);
        }
        latest = latest.max(time[*row]);
    }
    jumps
}

/// Positions at which a value differs from the one before.
fn changes<'a>(values: impl Iterator<Item = &'a f64>) -> Vec<usize> {
    let mut last = None;
    let differs = |(k, value): (usize, &f64)| {
        let before = last.replace(value.to_bits());
        before.is_some_and(|before| before != value.to_bits()).then_some(k)
    };
    values.enumerate().filter_map(differs).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(time: &[f64], values: &[f64]) -> Result<Rows, Error> {
        rows(time, &[values], None, &Lines::rows("a"))
    }

    #[test]
    fn rising_time_is_left_alone() {
        let found = of(&[0.0, 1.0, 5.0], &[1.0; 3]).unwrap();
        assert!(found.kept.is_none() && found.runs.is_empty() && found.repeated.is_empty());
    }

    #[test]
    fn disorder_is_sorted_and_what_was_sent_twice_counts_once() {
        let mut time = vec![0.0, 1.0, 3.0, 2.0, 4.0, 4.0, 4.0, f64::NAN, 5.0];
        let mut values = vec![0.0, 1.0, 3.0, 2.0, 4.0, 4.0, 4.5, 9.0, 5.0];
        // Many more rows, or the stamps would be coarse.
        time.extend((6..20).map(f64::from));
        values.extend((6..20).map(f64::from));
        let found = of(&time, &values).unwrap();
        assert_eq!(found.kept.unwrap()[..7], [0, 1, 3, 2, 4, 6, 8]);
        assert_eq!((found.disordered, found.repeated.samples), (1, 1));
        assert_eq!((found.repeated.listed[0].first, found.unstamped.listed[0].first), (6, 8));
    }

    #[test]
    fn a_jump_back_begins_a_run_and_the_position_follows_what_was_left_out() {
        let mut time: Vec<f64> = (0..50).map(f64::from).collect();
        time.insert(10, 9.0);
        time.extend((0..50).map(f64::from));
        let found = of(&time, &vec![1.0; time.len()]).unwrap();
        assert_eq!(found.runs, [50]);
        assert_eq!(found.kept.unwrap().len(), 100);
    }

    #[test]
    fn what_no_sorting_mends_is_refused() {
        let falling: Vec<f64> = (0..50).map(|k| -f64::from(k)).collect();
        assert!(matches!(of(&falling, &[1.0; 50]), Err(Error::TimeBackwards { .. })));
        let without = [f64::NAN, f64::NAN, 1.0];
        assert!(matches!(of(&without, &[1.0; 3]), Err(Error::TimeNotFinite { .. })));
    }
}
