//! The recording itself: uniformly sampled signals that share one time axis.

use crate::error::Error;
use crate::time_axis;

/// One signal: a name, the unit its values are in, and one value a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Canonical (`omega`, `i`, `u`, ...) or the name that the file gave.
    pub name: String,
    /// Unit of `values` as it is written in a column header (`rad/s`, `rpm`, `1` for none).
    pub unit: String,
    /// One value a sample.
    pub values: Vec<f64>,
}

impl Signal {
    /// The column header `name [unit]`.
    pub fn header(&self) -> String {
        format!("{} [{}]", self.name, if self.unit.is_empty() { "1" } else { &self.unit })
    }
}

/// Uniformly sampled signals: sample `k` of every signal lies at `start_s + k * period_s`.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// What the reader is told it came from (a file's name, a scenario).
    pub name: String,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Sampling time, s.
    pub period_s: f64,
    /// The signals, all of the same length, in the order of the file's columns.
    pub signals: Vec<Signal>,
}

impl Recording {
    /// Samples in each signal.
    pub fn len(&self) -> usize {
        self.signals.first().map_or(0, |signal| signal.values.len())
    }

    /// Whether there is no sample at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Time of sample `k`, s: `start + k * period`, never an accumulated sum.
    pub fn time(&self, k: usize) -> f64 {
        self.start_s + k as f64 * self.period_s
    }

    /// The signal of that name, if there is one.
    pub fn signal(&self, name: &str) -> Option<&Signal> {
        self.signals.iter().find(|signal| signal.name == name)
    }

    /// The signal of that name.
    ///
    /// # Errors
    /// [`Error::MissingSignal`] with the signals that are there.
    pub fn needed(&self, name: &str) -> Result<&Signal, Error> {
        self.signal(name).ok_or_else(|| Error::MissingSignal {
            file: self.name.clone(),
            signal: name.to_owned(),
            signals: self.signals.iter().map(Signal::header).collect::<Vec<_>>().join(", "),
        })
    }

    /// The same signals sampled every `period_s` from the same start, linearly interpolated.
    ///
    /// Nothing is filtered before: a longer sampling time folds fast parts down (aliasing).
    ///
    /// # Errors
    /// [`Error::Period`] unless `0 < period_s <= duration`.
    pub fn resample(&self, period_s: f64) -> Result<Recording, Error> {
        let time: Vec<f64> = (0..self.len()).map(|k| self.time(k)).collect();
        let samples = time_axis::samples(&self.name, &time, period_s)?;
        let onto = |signal: &Signal| Signal {
            name: signal.name.clone(),
            unit: signal.unit.clone(),
            values: time_axis::interpolate(&time, &signal.values, period_s, samples),
        };
        Ok(Recording {
            name: self.name.clone(),
            start_s: self.start_s,
            period_s,
            signals: self.signals.iter().map(onto).collect(),
        })
    }

    /// Checks that all signals have the same length.
    ///
    /// # Errors
    /// [`Error::UnequalLengths`] with the first that has not.
    pub fn check(&self) -> Result<(), Error> {
        let expected = self.len();
        match self.signals.iter().find(|signal| signal.values.len() != expected) {
            None => Ok(()),
            Some(signal) => Err(Error::UnequalLengths {
                name: self.name.clone(),
                signal: signal.name.clone(),
                found: signal.values.len(),
                expected,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Recording {
        let values = (0..101).map(f64::from).collect();
        let signals = vec![Signal { name: "u".into(), unit: "V".into(), values }];
        Recording { name: "ramp".into(), start_s: 2.0, period_s: 0.01, signals }
    }

    #[test]
    fn a_ramp_stays_a_ramp_when_resampled() {
        let slow = ramp().resample(0.025).unwrap();
        assert_eq!((slow.len(), slow.start_s, slow.period_s), (41, 2.0, 0.025));
        // 100 V/s: rounding of the time stamps near 3 s leaves some 1e-13 V.
        const ROUNDING: f64 = 1e-12;
        for (k, value) in slow.signals[0].values.iter().enumerate() {
            assert!((value - 2.5 * k as f64).abs() < ROUNDING, "sample {k}: {value}");
        }
        for bad in [0.0, -1.0, f64::NAN, 1.5] {
            assert!(matches!(ramp().resample(bad), Err(Error::Period { .. })), "{bad}");
        }
    }

    #[test]
    fn what_is_missing_or_unequal_is_named() {
        let mut recording = ramp();
        let missing = recording.needed("omega").unwrap_err().to_string();
        assert!(missing.contains("`omega`") && missing.contains("u [V]"), "{missing}");
        recording.signals.push(Signal { name: "i".into(), unit: "A".into(), values: vec![1.0] });
        assert!(matches!(recording.check(), Err(Error::UnequalLengths { found: 1, .. })));
    }
}
