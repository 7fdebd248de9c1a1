//! The recording itself: uniformly sampled signals that share one time axis.

use std::ops::Range;

use serde::Serialize;

use crate::clock::{Break, Clock};
use crate::error::Error;
use crate::time;

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
    /// Whether it is an input, held from sample to sample.
    pub(crate) fn is_held(&self) -> bool {
        self.name == "u"
    }

    /// The column header `name [unit]`.
    pub fn header(&self) -> String {
        format!("{} [{}]", self.name, if self.unit.is_empty() { "1" } else { &self.unit })
    }
}

/// One value a sample that is no number: what an FMU says beside its signals.
#[derive(Debug, Clone, PartialEq)]
pub struct TextSignal {
    pub name: String,
    /// One text a sample.
    pub values: Vec<String>,
}

/// Uniformly sampled signals of one machine, in one segment or several: sample `k` of every signal
/// lies at [`Recording::time`].
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
    /// Where further segments begin, in order; each is a run with a start of its own.
    pub breaks: Vec<Break>,
    /// What putting the rows on a uniform grid did to the sensors' white noise.
    pub noise_gain: NoiseGain,
}

/// Name of the column that numbers segments in files.
pub(crate) const SEGMENT: &str = "segment";

/// Orders of difference whose gain is known, the sample itself among them.
pub(crate) const DIFFERENCES: usize = 6;

/// How much smaller interpolation makes white noise: the standard deviation of differences over
/// that of the same differences of independent samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoiseGain {
    by_order: [f64; DIFFERENCES],
}

impl NoiseGain {
    /// Nothing was interpolated.
    pub const NONE: Self = Self { by_order: [1.0; DIFFERENCES] };

    pub(crate) fn of(by_order: [f64; DIFFERENCES]) -> Self {
        Self { by_order }
    }

    /// The gain of differences of that order, 0 for the samples themselves; beyond the fifth, that
    /// of the fifth.
    pub fn of_difference(&self, order: usize) -> f64 {
        self.by_order[order.min(DIFFERENCES - 1)]
    }
}

impl Recording {
    /// Signals in one segment, as they were sampled: from `start_s` on every `period_s`, s.
    pub fn new(name: impl Into<String>, start_s: f64, period_s: f64, signals: Vec<Signal>) -> Self {
        let (name, breaks, noise_gain) = (name.into(), Vec::new(), NoiseGain::NONE);
        Self { name, start_s, period_s, signals, breaks, noise_gain }
    }

    /// A recording without signals on the same time axis.
    #[must_use]
    pub fn like(&self) -> Self {
        Self { name: self.name.clone(), signals: Vec::new(), breaks: self.breaks.clone(), ..*self }
    }

    /// Samples in each signal.
    pub fn len(&self) -> usize {
        self.signals.first().map_or(0, |signal| signal.values.len())
    }

    /// Whether there is no sample at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// When the samples were taken.
    pub fn clock(&self) -> Clock {
        Clock { start_s: self.start_s, period_s: self.period_s, breaks: self.breaks.clone() }
    }

    /// Time of sample `k`, s.
    pub fn time(&self, k: usize) -> f64 {
        if self.breaks.is_empty() {
            return self.start_s + k as f64 * self.period_s;
        }
        self.clock().time(k)
    }

    /// The samples of each segment.
    pub fn segments(&self) -> Vec<Range<usize>> {
        self.clock().segments(self.len())
    }

    /// Each segment as a recording of its own.
    pub fn parts(&self) -> Vec<Recording> {
        let part = |samples: &Range<usize>| {
            let Clock { start_s, period_s, breaks } = self.clock().part(samples);
            let cut = |signal: &Signal| Signal {
                values: signal.values[samples.clone()].to_vec(),
                ..signal.clone()
            };
            let signals = self.signals.iter().map(cut).collect();
            let (name, noise_gain) = (self.name.clone(), self.noise_gain);
            Recording { name, start_s, period_s, signals, breaks, noise_gain }
        };
        self.segments().iter().map(part).collect()
    }

    /// The number of the segment, from 1 on, at every sample; none where there is one segment.
    pub(crate) fn segment_column(&self) -> Option<Signal> {
        let number = |(k, samples): (usize, Range<usize>)| samples.map(move |_| (k + 1) as f64);
        let values = || self.segments().into_iter().enumerate().flat_map(number).collect();
        let (name, unit) = (SEGMENT.to_owned(), "1".to_owned());
        (!self.breaks.is_empty()).then(|| Signal { name, unit, values: values() })
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

    /// The same signals sampled every `period_s` from the start of each segment on, linearly
    /// interpolated; an input (`u`) keeps its mean over each sample.
    ///
    /// Nothing is filtered before: a longer sampling time folds fast parts down (aliasing).
    ///
    /// # Errors
    /// [`Error::Period`] unless `0 < period_s <= duration` of some segment; shorter ones are left
    /// out.
    pub fn resample(&self, period_s: f64) -> Result<Recording, Error> {
        let mut parts: Vec<(Break, Vec<Vec<f64>>)> = Vec::new();
        let mut at = 0;
        let mut failed = None;
        for segment in self.segments() {
            let stamps: Vec<f64> = segment.clone().map(|k| self.time(k)).collect();
            let samples = match time::samples(&self.name, &stamps, period_s) {
                Ok(samples) => samples,
                Err(error) => {
                    failed = Some(error);
                    continue;
                }
            };
            let onto = |signal: &Signal| {
                let values = &signal.values[segment.clone()];
                match signal.is_held() {
                    true => time::held_mean(&stamps, values, period_s, samples),
                    false => time::interpolated(&stamps, values, period_s, samples),
                }
            };
            parts.push((Break { at, start_s: stamps[0] }, self.signals.iter().map(onto).collect()));
            at += samples;
        }
        let Some((first, _)) = parts.first() else {
            return Err(failed.unwrap_or_else(|| Error::HeaderOnly { file: self.name.clone() }));
        };
        let start_s = first.start_s;
        let joined = |k: usize| parts.iter().flat_map(|part| &part.1[k]).copied().collect();
        let signals = self.signals.iter().enumerate();
        let signals = signals.map(|(k, it)| Signal { values: joined(k), ..it.clone() }).collect();
        let breaks = parts.iter().skip(1).map(|part| part.0).collect();
        Ok(Recording { start_s, period_s, signals, breaks, ..self.clone() })
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
        let signals = vec![Signal { name: "i".into(), unit: "V".into(), values }];
        Recording::new("ramp", 2.0, 0.01, signals)
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
        assert!(missing.contains("`omega`") && missing.contains("i [V]"), "{missing}");
        recording.signals.push(Signal { name: "u".into(), unit: "A".into(), values: vec![1.0] });
        assert!(matches!(recording.check(), Err(Error::UnequalLengths { found: 1, .. })));
    }
    #[test]
    fn segments_have_their_own_clocks() {
        let mut two = ramp();
        two.breaks = vec![Break { at: 40, start_s: 9.0 }];
        assert_eq!(two.segments(), [0..40, 40..101]);
        assert_eq!(two.parts()[1].signals[0].values, two.signals[0].values[40..]);
        let slow = two.resample(0.02).unwrap();
        assert_eq!((slow.segments(), slow.time(20)), (vec![0..20, 20..51], 9.0));
        assert_eq!(slow.signals[0].values[19..22], [38.0, 40.0, 42.0]);
        two.breaks = vec![Break { at: 98, start_s: 9.0 }];
        assert_eq!(two.resample(0.1).unwrap().breaks, [], "a segment of 0.03 s is left out");
    }
}
