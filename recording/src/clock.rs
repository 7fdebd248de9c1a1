//! When samples were taken: uniform within segments, which begin when they begin.

use std::ops::Range;

use serde::Serialize;

/// Samples that a time may miss its sample by, relative to the period: `t_k = start + k h` is
/// rounded, and a sample that lies at `t_k` but for rounding is meant.
const SLACK: f64 = 1e-6;

/// The beginning of a further segment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Break {
    /// Its first sample.
    pub at: usize,
    /// Time of that sample, s; later than all before.
    pub start_s: f64,
}

/// The time axis of signals in one segment or several.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Sampling time, s.
    pub period_s: f64,
    /// Where further segments begin, in order.
    pub breaks: Vec<Break>,
}

impl Clock {
    /// Time of sample `k`, s: the segment's start + (samples since) * period, never an accumulated
    /// sum.
    pub fn time(&self, k: usize) -> f64 {
        let Break { at, start_s } = self.last_break(self.breaks.partition_point(|it| it.at <= k));
        start_s + (k - at) as f64 * self.period_s
    }

    /// The last sample that is not after `time_s`, as if the segment before a gap went on through
    /// it: no further than the gap. The first sample for times before it.
    pub fn sample(&self, time_s: f64) -> usize {
        let slack = SLACK * self.period_s;
        let after = self.breaks.partition_point(|it| it.start_s <= time_s + slack);
        let Break { at, start_s } = self.last_break(after);
        // The conversion saturates: negative numbers become 0, and so does a number that is none.
        let sample = at + ((time_s - start_s) / self.period_s + SLACK) as usize;
        self.breaks.get(after).map_or(sample, |next| sample.min(next.at - 1))
    }

    /// The samples of each segment of so many in all.
    pub fn segments(&self, samples: usize) -> Vec<Range<usize>> {
        parted(self.breaks.iter().map(|it| it.at), samples)
    }

    /// The clock of some of the samples.
    #[must_use]
    pub fn part(&self, samples: &Range<usize>) -> Self {
        let inside = self.breaks.iter().filter(|it| samples.start < it.at && it.at < samples.end);
        let breaks = inside.map(|it| Break { at: it.at - samples.start, ..*it }).collect();
        Self { start_s: self.time(samples.start), period_s: self.period_s, breaks }
    }

    fn last_break(&self, after: usize) -> Break {
        let first = Break { at: 0, start_s: self.start_s };
        after.checked_sub(1).map_or(first, |last| self.breaks[last])
    }
}

/// The ranges into which the beginnings of all but the first part so many rows.
pub(crate) fn parted(
    starts: impl Iterator<Item = usize> + Clone,
    rows: usize,
) -> Vec<Range<usize>> {
    let ends = starts.clone().chain([rows]);
    std::iter::once(0).chain(starts).zip(ends).map(|(from, to)| from..to).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_samples_are_each_other_s_inverse() {
        let breaks = vec![Break { at: 40, start_s: 9.0 }, Break { at: 70, start_s: 10.0 }];
        let clock = Clock { start_s: 2.0, period_s: 0.01, breaks };
        assert_eq!([clock.time(39), clock.time(40), clock.time(72)], [2.39, 9.0, 10.02]);
        assert!((0..100).all(|k| clock.sample(clock.time(k)) == k));
        assert_eq!(clock.segments(101), [0..40, 40..70, 70..101]);
        assert_eq!([clock.sample(0.0), clock.sample(5.0), clock.sample(9.996)], [0, 39, 69]);
        let part = clock.part(&(30..80));
        // The part's own start is rounded once more.
        assert!((0..50).all(|k| (part.time(k) - clock.time(30 + k)).abs() < 1e-12));
        assert_eq!(clock.part(&(40..70)).breaks, []);
    }
}
