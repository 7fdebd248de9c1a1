//! A detector of the paper at work.

use drivescope_diagnoser::{
    Data, Detector, DetectorError, Memory, MemoryError, ModelRun, RunRule, ThresholdRun, Verdict,
    Walk,
};

use crate::found::Found;
use crate::outside::Outside;
use crate::state::Shown;

/// A detector with what it found so far.
#[derive(Debug, Clone)]
pub(crate) struct OfResidual {
    pub(crate) detector: Detector<ModelRun, ThresholdRun>,
    pub(crate) rule: RunRule,
    /// Its error model explains nothing: it is not used.
    pub(crate) refused: bool,
    /// Samples at the start of a segment in which its models settle.
    pub(crate) settling: usize,
    /// What the residual of this machine and day is off by.
    pub(crate) offset: f64,
    /// Time of the last sample outside.
    pub(crate) last_outside: f64,
    pub(crate) counted: Outside,
    pub(crate) found: Found,
    pub(crate) standing: bool,
    pub(crate) shown: Shown,
}

impl OfResidual {
    /// A new segment begins.
    pub(crate) fn begin(&mut self) {
        self.rule.reset();
        self.found.end(self.last_outside, &mut self.standing);
    }

    /// Takes the sample of that number of its segment; whether a fault stands declared, and the
    /// verdict.
    pub(crate) fn step(
        &mut self,
        (u, y, time): (&[f64], f64, f64),
        (sample, beyond): (usize, bool),
    ) -> Result<(bool, Verdict), DetectorError> {
        if sample == 0 {
            self.detector.settle(u)?;
        }
        let verdict = self.detector.step(u, y - self.offset)?;
        let exceeds = verdict.exceeds && !beyond;
        if sample >= self.settling && !beyond {
            self.counted.step(1, usize::from(exceeds));
        }
        if exceeds {
            self.last_outside = time;
        }
        let declared = self.rule.step(exceeds);
        let Verdict { residual, lower, upper, .. } = verdict;
        self.shown = Shown { residual, lower, upper, outside: exceeds, standing: declared };
        Ok((declared, verdict))
    }
}

/// The memory of a residual begins in its detector; the rule is walked beside the detector's own,
/// which knows no operating range.
impl Memory for OfResidual {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.detector.walk(walk)?;
        self.rule.walk(walk)?;
        self.last_outside.walk(walk)?;
        self.counted.walk(walk)?;
        self.found.walk(walk)?;
        self.standing.walk(walk)?;
        let Shown { residual, lower, upper, outside, standing } = &mut self.shown;
        walk.each([residual, lower, upper])?;
        walk.each([outside, standing])
    }
}

/// Whether a healthy run is long enough to leave out what may be its start from rest.
pub(crate) fn starts_up(samples: usize, run_up: usize) -> bool {
    samples > 2 * run_up
}

/// What the middle of a detector's band is off the residual by, over a baseline.
pub(crate) fn offset(
    detector: &mut Detector<ModelRun, ThresholdRun>,
    data: &Data,
    run_up: usize,
) -> Result<f64, DetectorError> {
    let (mut sum, mut taken) = (0.0, 0.0);
    let mut u = vec![0.0; data.inputs().len()];
    for segment in data.segments() {
        for k in segment.clone() {
            u.iter_mut().zip(data.inputs()).for_each(|(u, column)| *u = column.values[k]);
            if k == segment.start {
                detector.settle(&u)?;
            }
            let verdict = detector.step(&u, data.output().values[k])?;
            if !starts_up(segment.len(), run_up) || k - segment.start >= run_up {
                sum += verdict.residual - 0.5 * (verdict.lower + verdict.upper);
                taken += 1.0;
            }
        }
    }
    Ok(sum / f64::max(taken, 1.0))
}
