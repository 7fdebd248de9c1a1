//! A detector of the paper as a statistic: the least of its last distances from the middle of its band.

use std::collections::VecDeque;

use drivescope_diagnoser::bank::Row;
use drivescope_diagnoser::{Detector, DetectorError, DetectorRun, ModelRun};

use crate::results::DetectorKind;
use crate::study::Designed;

/// Samples from the start from rest in which the models settle, within the baseline.
const SETTLED: usize = 500;

/// A detector of the paper along the rows of one machine.
pub(super) struct Along {
    detector: Detector<ModelRun, DetectorRun>,
    last: VecDeque<f64>,
    window: usize,
    offset: f64,
}

impl Along {
    /// One value for every row after the baseline.
    pub(super) fn over(
        designed: &Designed,
        method: DetectorKind,
        (rows, baseline, per_si): (&[Row], usize, f64),
    ) -> Result<Vec<f64>, DetectorError> {
        let window = designed.diagnoser.window;
        let detector = designed.diagnoser.detector(method)?;
        let mut along = Self { detector, last: VecDeque::new(), window, offset: 0.0 };
        let (mut sum, mut taken) = (0.0, 0.0);
        let mut made = Vec::with_capacity(rows.len().saturating_sub(baseline));
        for (k, row) in rows.iter().enumerate() {
            if k == baseline && taken > 0.0 {
                along.offset = sum / taken;
            }
            let verdict = along.detector.step(&[row.control], per_si * row.shown[0])?;
            let off = verdict.residual - 0.5 * (verdict.lower + verdict.upper);
            if k < baseline {
                if k >= SETTLED.min(baseline / 2) {
                    (sum, taken) = (sum + off, taken + 1.0);
                }
                continue;
            }
            let half = 0.5 * (verdict.upper - verdict.lower);
            made.push(along.least((off - along.offset).abs() / half));
        }
        Ok(made)
    }

    /// The least of the last distances; nothing is out before there are as many.
    fn least(&mut self, distance: f64) -> f64 {
        if self.last.len() == self.window {
            self.last.pop_front();
        }
        self.last.push_back(distance);
        if self.last.len() < self.window {
            return 0.0;
        }
        self.last.iter().copied().fold(f64::INFINITY, f64::min)
    }
}
