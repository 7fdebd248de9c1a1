//! The recording itself: uniformly sampled signals that share one time axis.

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
}
