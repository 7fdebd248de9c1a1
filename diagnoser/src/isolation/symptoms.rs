//! Symptoms: what is seen under every fault (Fig. 5), as samples of a few signals.

use std::ops::Range;

use thiserror::Error;

use crate::data::Data;
use crate::decision::Trace;

/// Why symptoms do not serve.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SymptomError {
    /// Fewer than two faults cannot be told apart.
    #[error("isolation needs symptoms of at least two faults, there are {faults}")]
    TooFewFaults {
        /// Faults given.
        faults: usize,
    },
    /// Too few samples of a fault.
    #[error("fault {fault} has {samples} samples, at least {needed} are needed")]
    TooFewSamples {
        /// Its name.
        fault: String,
        /// Samples given.
        samples: usize,
        /// Fewest samples.
        needed: usize,
    },
    /// Samples of different length.
    #[error(
        "fault {fault}: sample {sample} holds {found} signals where the first holds {expected}"
    )]
    Signals {
        /// Its name.
        fault: String,
        /// The sample, from 0.
        sample: usize,
        /// Signals of the first sample of all.
        expected: usize,
        /// Signals found.
        found: usize,
    },
    /// NaN or infinity.
    #[error("fault {fault}: sample {sample} is not finite")]
    NotFinite {
        /// Its name.
        fault: String,
        /// The sample, from 0.
        sample: usize,
    },
    /// A signal that is the same under all faults.
    #[error("signal {signal} of the symptoms is constant at {value}: leave it out")]
    Constant {
        /// Which signal, from 0.
        signal: usize,
        value: f64,
    },
    /// The samples asked for are not in the run.
    #[error("{count} samples cannot be taken from samples {} to {} of a run of {samples}", span.start, span.end)]
    Span {
        /// The span asked for.
        span: Range<usize>,
        /// Samples asked for.
        count: usize,
        /// Samples of the run.
        samples: usize,
    },
}

/// Symptoms of one fault.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultSymptoms {
    /// Name of the fault.
    pub fault: String,
    /// Samples; every one holds the same signals.
    pub samples: Vec<Vec<f64>>,
}

/// Symptoms of all faults, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Symptoms {
    faults: Vec<FaultSymptoms>,
}

impl Symptoms {
    /// Checks that there are two faults or more with at least four samples each, of the same
    /// signals, all finite, and that every signal varies.
    pub fn new(faults: Vec<FaultSymptoms>) -> Result<Self, SymptomError> {
        const NEEDED: usize = 4;
        if faults.len() < 2 {
            return Err(SymptomError::TooFewFaults { faults: faults.len() });
        }
        for FaultSymptoms { fault, samples } in &faults {
            if samples.len() < NEEDED {
                let (fault, samples) = (fault.clone(), samples.len());
                return Err(SymptomError::TooFewSamples { fault, samples, needed: NEEDED });
            }
        }
        let expected = faults[0].samples[0].len();
        for FaultSymptoms { fault, samples } in &faults {
            for (sample, values) in samples.iter().enumerate() {
                let (fault, found) = (fault.clone(), values.len());
                if found != expected {
                    return Err(SymptomError::Signals { fault, sample, expected, found });
                }
                if values.iter().any(|value| !value.is_finite()) {
                    return Err(SymptomError::NotFinite { fault, sample });
                }
            }
        }
        for signal in 0..expected {
            let value = faults[0].samples[0][signal];
            let mut all = faults.iter().flat_map(|fault| &fault.samples);
            if all.all(|sample| sample[signal] == value) {
                return Err(SymptomError::Constant { signal, value });
            }
        }
        Ok(Self { faults })
    }

    /// The faults, in the order given.
    pub fn faults(&self) -> &[FaultSymptoms] {
        &self.faults
    }

    /// Signals of a sample.
    pub fn signals(&self) -> usize {
        self.faults[0].samples[0].len()
    }
}

/// Symptoms (u_1.., r) of one run: `count` samples evenly spread over a span of it, as the paper has
/// 100 of every fault.
pub fn symptoms_of(
    data: &Data,
    trace: &Trace,
    span: Range<usize>,
    count: usize,
) -> Result<Vec<Vec<f64>>, SymptomError> {
    let samples = trace.verdicts.len().min(data.len());
    if span.end > samples || span.len() < count {
        return Err(SymptomError::Span { span, count, samples });
    }
    let sample = |i: usize| {
        let k = span.start + i * span.len() / count;
        let inputs = data.inputs().iter().map(|column| column.values[k]);
        inputs.chain([trace.verdicts[k].residual]).collect()
    };
    Ok((0..count).map(sample).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Column;
    use crate::verdict::Verdict;

    fn fault(samples: Vec<Vec<f64>>) -> FaultSymptoms {
        FaultSymptoms { fault: "tacho +5 %".into(), samples }
    }

    #[test]
    fn samples_are_spread_evenly_over_the_span() {
        let u: Vec<f64> = (0..100).map(f64::from).collect();
        let column = Column { name: "u", values: &u };
        let data = Data::new(vec![column], column).unwrap();
        let verdict = |k: &f64| Verdict {
            residual: -k,
            lower: 0.0,
            upper: 0.0,
            exceeds: true,
            declared: true,
        };
        let trace = Trace { verdicts: u.iter().map(verdict).collect(), run_up: 0, window: 1 };
        let samples = symptoms_of(&data, &trace, 20..60, 4).unwrap();
        assert_eq!(samples, [[20.0, -20.0], [30.0, -30.0], [40.0, -40.0], [50.0, -50.0]]);
        let beyond = symptoms_of(&data, &trace, 80..101, 4);
        assert!(matches!(beyond, Err(SymptomError::Span { samples: 100, .. })));
        assert!(symptoms_of(&data, &trace, 0..3, 4).is_err());
    }

    #[test]
    fn unusable_symptoms_are_refused_by_fault_and_sample() {
        let good = || fault((0..5).map(|k| vec![f64::from(k), 1.0 - f64::from(k)]).collect());
        assert!(Symptoms::new(vec![good(), good()]).is_ok());
        assert_eq!(Symptoms::new(vec![good()]), Err(SymptomError::TooFewFaults { faults: 1 }));
        let refused = |samples| Symptoms::new(vec![good(), fault(samples)]).unwrap_err();
        let few = refused(vec![vec![0.0, 0.0]; 3]);
        assert!(few.to_string().contains("tacho +5 % has 3 samples"), "{few}");
        let ragged = refused(vec![vec![0.0; 2], vec![0.0; 2], vec![0.0; 3], vec![0.0; 2]]);
        assert!(matches!(ragged, SymptomError::Signals { sample: 2, found: 3, .. }));
        let gap = refused(vec![vec![0.0; 2], vec![f64::NAN, 0.0], vec![0.0; 2], vec![0.0; 2]]);
        assert!(matches!(gap, SymptomError::NotFinite { sample: 1, .. }));
        let still = fault(vec![vec![0.0, 7.0], vec![1.0, 7.0], vec![2.0, 7.0], vec![3.0, 7.0]]);
        let refusal = Symptoms::new(vec![still.clone(), still]).unwrap_err();
        assert_eq!(refusal, SymptomError::Constant { signal: 1, value: 7.0 });
    }
}
