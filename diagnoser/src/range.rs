//! Operating points that a diagnoser was designed on: beyond them it does not judge.
//!
//! A fault moves input and output against each other: under a load the effort rises and the speed
//! falls or is held. A set point that was never shown moves both the same way. So a point is beyond
//! the range where the means of the output and of an input over a window both lie outside what was
//! shown, on the same side (of an input that lowers the output, on opposite sides).

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::data::Data;
use crate::memory::{Memory, MemoryError, Walk};

/// What a mean may lie outside, as a share of what was shown and of the noise about it.
const MARGIN: f64 = 0.1;

/// Lowest and highest mean over a window of every input and of the output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OperatingRange {
    /// Samples of a window.
    pub samples: usize,
    pub inputs: Vec<[f64; 2]>,
    pub output: [f64; 2],
    /// Whether each input raises the output.
    pub raises: Vec<bool>,
}

/// Widens a range to hold another.
fn hull(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// -1 below a range and its margin, 1 above it, 0 inside.
fn side(value: f64, range: [f64; 2]) -> i8 {
    let margin = MARGIN * (range[1] - range[0]).max(MARGIN * range[1].abs().max(range[0].abs()));
    i8::from(value > range[1] + margin) - i8::from(value < range[0] - margin)
}

impl OperatingRange {
    /// The range of some runs; nothing if none is as long as a window.
    pub fn of(runs: &[&Data], samples: usize) -> Option<Self> {
        const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
        let inputs = runs.first()?.inputs().len();
        let mut range = Self {
            samples,
            inputs: vec![NOTHING; inputs],
            output: NOTHING,
            raises: vec![true; inputs],
        };
        let (mut points, mut products) = (0, vec![0.0; inputs]);
        let mut sums = vec![0.0; inputs + 1];
        for data in runs {
            for segment in data.segments() {
                for first in segment.clone().step_by(samples).filter(|k| k + samples <= segment.end)
                {
                    let mean = |values: &[f64]| {
                        values[first..first + samples].iter().sum::<f64>() / samples as f64
                    };
                    let y = mean(data.output().values);
                    range.output = hull(range.output, [y, y]);
                    for (k, column) in data.inputs().iter().enumerate() {
                        let u = mean(column.values);
                        range.inputs[k] = hull(range.inputs[k], [u, u]);
                        products[k] += u * y;
                        sums[k] += u;
                    }
                    sums[inputs] += y;
                    points += 1;
                }
            }
        }
        if points == 0 {
            return None;
        }
        for k in 0..inputs {
            range.raises[k] = products[k] - sums[k] * sums[inputs] / f64::from(points) >= 0.0;
        }
        Some(range)
    }

    /// The range with that of a baseline.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let inputs = self.inputs.iter().zip(&other.inputs).map(|(a, b)| hull(*a, *b)).collect();
        Self { inputs, output: hull(self.output, other.output), ..self.clone() }
    }

    /// Where a run is, from here on.
    pub fn watch(self) -> RangeWatch {
        let sums = vec![0.0; self.inputs.len() + 1];
        RangeWatch { range: self, last: VecDeque::new(), sums }
    }
}

/// Inputs and output of a sample.
#[derive(Debug, Clone)]
struct Sample(Vec<f64>);

impl Memory for Sample {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each(&mut self.0)
    }
}

/// Means over the last window.
#[derive(Debug, Clone)]
pub struct RangeWatch {
    range: OperatingRange,
    last: VecDeque<Sample>,
    sums: Vec<f64>,
}

impl RangeWatch {
    /// After a gap the window is empty.
    pub fn reset(&mut self) {
        self.last.clear();
        self.sums.fill(0.0);
    }

    /// Takes a sample; whether the run is beyond the range.
    pub fn step(&mut self, u: &[f64], y: f64) -> bool {
        let row: Vec<f64> = u.iter().copied().chain([y]).collect();
        self.last.push_back(Sample(row));
        if self.last.len() > self.range.samples {
            self.last.pop_front();
        }
        // Summed anew: differences of a running sum would depend on all that was before.
        self.sums.fill(0.0);
        for Sample(row) in &self.last {
            self.sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
        }
        let n = self.last.len() as f64;
        let (y, u) = self.sums.split_last().map_or((f64::NAN, &[][..]), |(y, u)| (*y, u));
        let of_output = side(y / n, self.range.output);
        let ranges = self.range.inputs.iter().zip(&self.range.raises);
        of_output != 0
            && u.iter().zip(ranges).any(|(u, (range, raises))| {
                let of_input = side(u / n, *range);
                of_input == if *raises { of_output } else { -of_output }
            })
    }
}

impl Memory for RangeWatch {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        let signals = self.sums.len();
        walk.list(&mut self.last, self.range.samples, || Sample(vec![0.0; signals]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;

    #[test]
    fn another_set_point_is_beyond_and_a_fault_is_not() {
        let u: Vec<f64> = (0..400).map(|k| if k < 200 { 4.0 } else { 5.0 }).collect();
        let y: Vec<f64> = u.iter().map(|u| 100.0 * u).collect();
        let (input, output) = (Column { name: "u", values: &u }, Column { name: "y", values: &y });
        let data = Data::new(vec![input], output).expect("finite");
        let range = OperatingRange::of(&[&data], 50).expect("long enough");
        assert_eq!((range.inputs[0], range.output), ([4.0, 5.0], [400.0, 500.0]));
        let beyond = |u: f64, y: f64| {
            let mut watch = range.clone().watch();
            (0..60).map(|_| watch.step(&[u], y)).next_back()
        };
        assert_eq!(beyond(4.5, 450.0), Some(false));
        assert_eq!(beyond(8.0, 800.0), Some(true));
        assert_eq!(beyond(2.0, 200.0), Some(true));
        // A load: more effort, less speed; a tachometer: more effort, the same speed.
        assert_eq!(beyond(8.0, 300.0), Some(false));
        assert_eq!(beyond(8.0, 500.0), Some(false));
        let other = OperatingRange { inputs: vec![[8.0; 2]], output: [800.0; 2], ..range.clone() };
        let mut wider = range.and(&other).watch();
        assert!(!(0..60).any(|_| wider.step(&[8.0], 800.0)));
        assert!(OperatingRange::of(&[&data], 500).is_none());
    }
}
