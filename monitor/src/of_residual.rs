//! A detector of the residual at work.

use drivescope_diagnoser::{
    Confidence, Data, Detector, DetectorError, DetectorKind, DetectorRun, Diagnoser, Memory,
    MemoryError, ModelRun, RunRule, Verdict, Walk,
};

use crate::found::Found;
use crate::method::Method;
use crate::outside::Outside;
use crate::state::Shown;

/// A detector with what it found so far.
#[derive(Debug, Clone)]
pub(crate) struct OfResidual {
    pub(crate) detector: Detector<ModelRun, DetectorRun>,
    pub(crate) rule: RunRule,
    /// Exceedances in a row that declare a fault.
    pub(crate) window: usize,
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
    /// A detector that the diagnoser holds, at its start; `healthy` is a run of the machine or day.
    pub(crate) fn new(
        diagnoser: &Diagnoser,
        kind: DetectorKind,
        (asked, confidence): (Method, Confidence),
        healthy: Option<&Data>,
    ) -> Result<Self, DetectorError> {
        let method = Method::Residual(kind);
        let mut detector = diagnoser.detector_at(kind, confidence)?;
        let offset = match healthy {
            Some(data) => offset(&mut detector, data, diagnoser.run_up)?,
            None => 0.0,
        };
        detector.reset();
        let has_level = kind.info().instead_of_level.is_none();
        let window = diagnoser.window_of(kind);
        Ok(Self {
            detector,
            rule: RunRule::new(window),
            window,
            refused: !diagnoser.explains(kind) && method != asked,
            settling: diagnoser.run_up_of(kind),
            offset,
            last_outside: 0.0,
            counted: Outside::default(),
            found: Found::new(method, has_level.then_some(confidence.beta())),
            standing: false,
            shown: Shown::default(),
        })
    }

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
        if beyond {
            self.detector.disregard();
        }
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

/// What a detector expects of a healthy residual is off by, over a baseline.
fn offset(
    detector: &mut Detector<ModelRun, DetectorRun>,
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
                sum += verdict.residual - detector.expected(&verdict);
                taken += 1.0;
            }
        }
    }
    Ok(sum / f64::max(taken, 1.0))
}
