//! Residuals and columns gathered over groups of samples, so that memory is bounded.
//!
//! A row is the sum of the measured values of an output over a group, over the root of their
//! number: white noise of unit variance stays that. Up to [`MOST_GROUPS`] samples a group is one
//! sample; of longer recordings faster parts are averaged out.

use crate::case::Case;

/// Groups over all recordings at most: 200 columns of two outputs then take 105 MB.
const MOST_GROUPS: usize = 32_768;

/// Which samples a row holds: row = group * outputs + output.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub(super) outputs: usize,
    /// Samples in a group.
    pub(super) stride: usize,
    /// First group of each recording, and the end.
    pub(super) starts: Vec<usize>,
    /// Length of a group, s.
    pub(super) group_s: f64,
    /// Measured values in each row.
    counts: Vec<f64>,
}

impl Layout {
    pub(super) fn new(cases: &[Case<'_>]) -> Self {
        let samples: usize = cases.iter().map(|case| case.measured.len()).sum();
        let stride = samples.div_ceil(MOST_GROUPS).max(1);
        let outputs = cases.first().map_or(0, |case| case.measured.outputs.len());
        let mut starts = vec![0];
        for case in cases {
            starts.push(starts[starts.len() - 1] + case.measured.len().div_ceil(stride));
        }
        let rows = starts[starts.len() - 1] * outputs;
        let period_s = cases.first().map_or(1.0, |case| case.measured.period_s);
        let counts = vec![0.0; rows];
        let mut layout =
            Self { outputs, stride, starts, group_s: stride as f64 * period_s, counts };
        for (place, case) in cases.iter().enumerate() {
            for k in case.measured.pieces.iter().cloned().flatten() {
                for (j, channel) in case.measured.outputs.iter().enumerate() {
                    if channel.values[k].is_finite() {
                        let row = layout.row(place, k, j);
                        layout.counts[row] += 1.0;
                    }
                }
            }
        }
        layout
    }

    /// The row of a sample's output.
    pub(super) fn row(&self, place: usize, sample: usize, output: usize) -> usize {
        (self.starts[place] + sample / self.stride) * self.outputs + output
    }

    pub(super) fn rows(&self) -> usize {
        self.counts.len()
    }

    /// Rows that hold something.
    pub(super) fn values(&self) -> f64 {
        self.counts.iter().filter(|count| **count > 0.0).count() as f64
    }

    /// Sums over groups, made values of unit noise.
    pub(super) fn level(&self, column: &mut [f64]) {
        for (value, count) in column.iter_mut().zip(&self.counts) {
            *value = if *count > 0.0 { *value / count.sqrt() } else { 0.0 };
        }
    }

    /// Number of the block of each row, for blocks of about that length, and how many there are;
    /// a block does not reach from one recording into the next, and none is shorter than a group.
    pub(super) fn blocks(&self, block_s: f64) -> (Vec<usize>, usize) {
        let mut numbers = Vec::with_capacity(self.rows());
        let mut first = 0;
        for span in self.starts.windows(2) {
            let groups = span[1] - span[0];
            let wanted = (groups as f64 * self.group_s / block_s).round() as usize;
            let wanted = wanted.min(groups).max(1);
            for group in 0..groups {
                let number = first + group * wanted / groups;
                numbers.extend(std::iter::repeat_n(number, self.outputs));
            }
            first += wanted;
        }
        (numbers, first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_never_shorter_than_a_sample() {
        let of = |group_s: f64| Layout {
            outputs: 2,
            stride: 1,
            starts: vec![0, 300, 500],
            group_s,
            counts: vec![1.0; 1000],
        };
        let (numbers, count) = of(2000.0).blocks(0.5);
        assert_eq!((numbers.len(), count), (1000, 500));
        let (numbers, count) = of(1e-3).blocks(0.1);
        assert_eq!((numbers.len(), count), (1000, 5));
        assert_eq!((numbers[0], numbers[999]), (0, 4));
    }
}
