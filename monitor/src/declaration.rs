//! A declared fault: since when, until when, what and how large.

use drivescope_diagnoser::{Memory, MemoryError, Walk};
use serde::Serialize;

/// Mechanism of a declaration that nothing known explains.
pub const UNKNOWN: &str = "unknown";
/// Names in a set at most.
const MOST: usize = 64;

/// A fault as it stands in the answer and in the lines of a live run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Declaration {
    /// Time of its first sample, s.
    pub from: f64,
    /// Time of its last sample, s; none while it stands.
    pub to: Option<f64>,
    /// Time at which it was noticed, s.
    pub noticed: f64,
    /// Samples from the start of the recording until then, that one included.
    #[serde(skip)]
    pub sample: usize,
    /// What failed, or `unknown`.
    pub mechanism: String,
    /// Everything that it may be: the mechanism and those that it cannot be told from.
    pub set: Vec<String>,
    /// Size in `unit`, of a fault that grows that at the last judgement; none where nothing is named,
    /// or the method tells no size.
    pub size: Option<f64>,
    /// Its 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// Unit of the size, `1` for a fraction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Change of the size a second, where it grows, and its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub growth: Option<[f64; 2]>,
}

impl Declaration {
    /// A fault of which nothing but its begin is known.
    pub fn unknown(from: f64, noticed: f64) -> Self {
        Self {
            from,
            to: None,
            noticed,
            sample: 0,
            mechanism: UNKNOWN.to_owned(),
            set: Vec::new(),
            size: None,
            interval: None,
            unit: None,
            growth: None,
        }
    }

    /// One that another's memory is restored into.
    pub(crate) fn blank() -> Self {
        Self::unknown(0.0, 0.0)
    }
}

impl Memory for Declaration {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each([&mut self.from, &mut self.noticed])?;
        walk.maybe(&mut self.to, || 0.0)?;
        self.sample.walk(walk)?;
        self.mechanism.walk(walk)?;
        let mut set = std::mem::take(&mut self.set).into();
        walk.list(&mut set, MOST, String::new)?;
        self.set = set.into();
        walk.maybe(&mut self.size, || 0.0)?;
        walk.maybe(&mut self.interval, || [0.0; 2])?;
        walk.maybe(&mut self.unit, String::new)?;
        walk.maybe(&mut self.growth, || [0.0; 2])
    }
}
