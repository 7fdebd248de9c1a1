//! The running detector: residual, band and decision, one sample at a time in fixed memory.

use thiserror::Error;

use crate::data::Data;
use crate::decision::{RunRule, Trace};
use crate::detectors::{Judged, ResidualTest};
use crate::memory::{Memory, MemoryError, Walk};
use crate::signal_model::SignalModel;
use crate::threshold::Band;
use crate::verdict::Verdict;

/// Why a detector cannot be built or a sample cannot be judged.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum DetectorError {
    /// The model has several outputs or none.
    #[error("a detector watches one output, the model has {outputs}")]
    Outputs {
        /// Outputs of the model.
        outputs: usize,
    },
    /// The diagnoser was designed without it.
    #[error("this diagnoser holds no {part}: design it with one")]
    Missing {
        /// What was asked for.
        part: &'static str,
    },
    /// Stored parameter sets that describe no bounded set.
    #[error("the parameter sets of the GMDH network are damaged: design them again")]
    DamagedBounds,
    /// Not as many inputs as the model takes.
    #[error("sample {sample} holds {given} inputs, the model takes {expected}")]
    Inputs {
        /// The sample, counted from the start of the run.
        sample: usize,
        /// Inputs given.
        given: usize,
        /// Inputs of the model.
        expected: usize,
    },
    /// NaN or infinity; the sample was not taken, the detector stands as before it.
    #[error(
        "sample {sample} is not finite: a gap must be bridged or the detector be reset after it"
    )]
    NotFinite {
        /// The sample, counted from the start of the run.
        sample: usize,
    },
}

/// A process model, a test of its residual and the decision, running; its clone is its state.
#[derive(Debug, Clone)]
pub struct Detector<M, T> {
    model: M,
    test: T,
    rule: RunRule,
    window: usize,
    run_up: usize,
    sample: usize,
}

impl<M: SignalModel, T: ResidualTest> Detector<M, T> {
    /// A detector at its start. During the first `run_up` samples the models settle from rest to
    /// where the drive is, and nothing is judged; `window` exceedances in a row declare a fault.
    pub fn new(model: M, test: T, window: usize, run_up: usize) -> Result<Self, DetectorError> {
        let outputs = model.outputs();
        if outputs != 1 {
            return Err(DetectorError::Outputs { outputs });
        }
        let rule = RunRule::new(window);
        let mut detector = Self { model, test, rule, window, run_up, sample: 0 };
        detector.reset();
        Ok(detector)
    }

    /// Back to the start.
    pub fn reset(&mut self) {
        self.model.reset();
        self.test.reset();
        self.rule.reset();
        self.sample = 0;
    }

    /// Starts in the steady state of the inputs `u`, where a machine that runs is found.
    ///
    /// # Errors
    /// Inputs that are not those of the model.
    pub fn settle(&mut self, u: &[f64]) -> Result<(), DetectorError> {
        self.reset();
        let (given, expected) = (u.len(), self.model.inputs());
        if given != expected {
            return Err(DetectorError::Inputs { sample: 0, given, expected });
        }
        if !u.iter().all(|u| u.is_finite()) {
            return Err(DetectorError::NotFinite { sample: 0 });
        }
        self.model.settle(u);
        self.test.settle(u);
        Ok(())
    }

    /// Takes inputs `u` and measured output `y` of the next sample.
    #[inline]
    pub fn step(&mut self, u: &[f64], y: f64) -> Result<Verdict, DetectorError> {
        let sample = self.sample;
        let expected = self.model.inputs();
        if u.len() != expected {
            return Err(DetectorError::Inputs { sample, given: u.len(), expected });
        }
        if !(y.is_finite() && u.iter().all(|u| u.is_finite())) {
            return Err(DetectorError::NotFinite { sample });
        }
        let residual = y - self.model.step(u)[0];
        let Judged { band, exceeds } = self.test.step(u, residual);
        let is_judged = sample >= self.run_up;
        if !is_judged {
            self.test.disregard();
        }
        let exceeds = is_judged && exceeds;
        let declared = self.rule.step(exceeds);
        self.sample += 1;
        Ok(Verdict { residual, lower: band.lower, upper: band.upper, exceeds, declared })
    }

    /// The sample that was taken last is not judged: its residual is to count for nothing later.
    #[inline]
    pub fn disregard(&mut self) {
        self.test.disregard();
    }

    /// What the residual of a healthy machine was expected to be at the sample of that verdict, the
    /// last one, output unit.
    pub fn expected(&self, verdict: &Verdict) -> f64 {
        self.test.middle(Band { lower: verdict.lower, upper: verdict.upper })
    }

    /// Runs over whole signals from the start: the same steps in a loop.
    pub fn run(&mut self, data: &Data) -> Result<Trace, DetectorError> {
        self.reset();
        let mut u = vec![0.0; data.inputs().len()];
        let measured = data.output().values;
        let verdicts = (0..data.len())
            .map(|k| {
                if data.segments().iter().any(|segment| segment.start == k) {
                    self.reset();
                }
                for (u, column) in u.iter_mut().zip(data.inputs()) {
                    *u = column.values[k];
                }
                self.step(&u, measured[k])
            })
            .collect::<Result<_, _>>()?;
        Ok(Trace { verdicts, run_up: self.run_up, window: self.window })
    }
}

impl<M: Memory, T: Memory> Memory for Detector<M, T> {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.model.walk(walk)?;
        self.test.walk(walk)?;
        self.rule.walk(walk)?;
        self.sample.walk(walk)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::arx::Arx;
    use crate::data::Column;
    use crate::model_error::ErrorBands;
    use crate::testing::noise;
    use crate::threshold::Confidence;

    fn detector() -> Detector<crate::arx::ArxRun, ErrorBands<crate::arx::ArxRun>> {
        let model = Arc::new(Arx { a: vec![-0.8], b: vec![vec![1.0, 0.5]], constant: 0.1 });
        let error = Arc::new(Arx { a: vec![-0.3, 0.1], b: vec![vec![0.2]], constant: -0.4 });
        let bands = ErrorBands::new(error.run(), 1.0, Confidence::new(0.05).unwrap());
        Detector::new(model.run(), bands, 5, 20).unwrap()
    }

    #[test]
    fn batch_equals_stream_bit_for_bit_and_a_clone_replays() {
        let (u, y) = (noise(500, 1), noise(500, 2));
        let data =
            Data::new(vec![Column { name: "u", values: &u }], Column { name: "y", values: &y })
                .unwrap();
        let batch = detector().run(&data).unwrap();
        let mut stream = detector();
        let mut copy = stream.clone();
        for k in 0..500 {
            if k == 250 {
                copy = stream.clone();
            }
            assert_eq!(stream.step(&[u[k]], y[k]).unwrap(), batch.verdicts[k]);
        }
        for k in 250..500 {
            assert_eq!(copy.step(&[u[k]], y[k]).unwrap(), batch.verdicts[k]);
        }
        assert!(batch.verdicts[..20].iter().all(|verdict| !verdict.exceeds));
        assert!(batch.verdicts[20..].iter().any(|verdict| verdict.exceeds));
    }

    #[test]
    fn a_refused_sample_leaves_the_detector_as_it_was() {
        let mut detector = detector();
        detector.step(&[1.0], 0.0).unwrap();
        let before = detector.clone().step(&[2.0], 1.0).unwrap();
        assert_eq!(detector.step(&[f64::NAN], 1.0), Err(DetectorError::NotFinite { sample: 1 }));
        assert_eq!(detector.step(&[1.0], f64::NAN), Err(DetectorError::NotFinite { sample: 1 }));
        assert_eq!(
            detector.step(&[1.0, 2.0], 0.0),
            Err(DetectorError::Inputs { sample: 1, given: 2, expected: 1 })
        );
        assert_eq!(detector.step(&[2.0], 1.0).unwrap(), before);
    }

    #[test]
    fn a_band_that_nothing_leaves_never_alarms() {
        let model = Arc::new(Arx { a: vec![], b: vec![vec![1.0]], constant: 0.0 });
        let wide = Band { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        let mut detector = Detector::new(model.run(), wide, 1, 0).unwrap();
        for (u, y) in noise(100, 3).into_iter().zip(noise(100, 4)) {
            assert!(!detector.step(&[u], 1e9 * y).unwrap().declared);
        }
    }
}
