//! Segments on the grid, one behind the other on one clock.

use std::ops::Range;

use super::rate::Way;

/// Pause put between segments where the clock of the later one runs back, s.
const PAUSE_S: f64 = 1.0;

/// A run without a break.
pub(super) struct Segment {
    pub(super) rows: Range<usize>,
    pub(super) start_s: f64,
    pub(super) samples: usize,
    pub(super) way: Way,
    /// Whether its stamps begin before those of the segment before it end.
    pub(super) runs_back: bool,
}

/// Moves segments whose stamps run back, and those that belong to the same run, to after the one
/// before; how often stamps run back.
pub(super) fn one_clock(segments: &mut [Segment], period_s: f64) -> usize {
    let (mut moved, mut by_s, mut end_s) = (0, 0.0, f64::NEG_INFINITY);
    for segment in segments {
        if segment.runs_back {
            by_s = end_s + PAUSE_S.max(10.0 * period_s) - segment.start_s;
            moved += 1;
        }
        segment.start_s += by_s;
        // Rows that were stamped late at a break put grids into each other by their jitter.
        if segment.start_s < end_s + 0.5 * period_s {
            segment.start_s = end_s + period_s;
        }
        end_s = segment.start_s + (segment.samples - 1) as f64 * period_s;
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Starts of segments of ten samples, 1 s apart, and how often the clock ran back.
    fn put(starts: &[(f64, bool)]) -> (Vec<f64>, usize) {
        let of = |(start_s, runs_back): &(f64, bool)| Segment {
            rows: 0..10,
            start_s: *start_s,
            samples: 10,
            way: Way::Places(None),
            runs_back: *runs_back,
        };
        let mut segments: Vec<Segment> = starts.iter().map(of).collect();
        let moved = one_clock(&mut segments, 1.0);
        (segments.iter().map(|it| it.start_s).collect(), moved)
    }

    #[test]
    fn only_stamps_that_run_back_are_said_to() {
        assert_eq!(put(&[(0.0, false), (9.3, false), (30.0, false)]), (vec![0.0, 10.0, 30.0], 0));
    }

    #[test]
    fn a_run_that_is_set_behind_keeps_its_own_gaps() {
        let (starts, moved) = put(&[(0.0, false), (2.0, true), (15.0, false)]);
        assert_eq!((starts, moved), (vec![0.0, 19.0, 32.0], 1));
    }
}
