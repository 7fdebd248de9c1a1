//! What is found about a signal.

use std::fmt;
use std::ops::Range;

use drivescope_recording::Clock;
use serde::Serialize;

/// What is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// The outputs do not follow what drives: noise, or another run's.
    NoAnswer,
    /// They follow it seconds earlier or later.
    Shifted,
    /// The sign of a channel is turned.
    Sign,
    /// A channel is in another unit than it says.
    Unit,
    /// Nothing moves.
    AtRest,
    /// Only one magnitude of the speed.
    OneSpeed,
    /// Only one direction.
    OneDirection,
    /// Single samples far beside their neighbours.
    Spikes,
    /// The sensor keeps a value while everything else moves.
    Frozen,
    /// The signal sits at its greatest or least value.
    Saturated,
    /// Few levels over the whole range.
    Coarse,
    /// A sensor slower than the recording keeps its value in between.
    Held,
    /// A position that rows repeat while the shaft moves on.
    Repeated,
    /// Speed or position shows the motion later than the other.
    Late,
    /// Values that are not there.
    Missing,
}

/// What follows from it, the gravest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Consequence {
    /// Nothing can be judged by this recording.
    NotJudged,
    /// The values were set to missing, or put between their neighbours.
    Repaired,
    /// Something cannot be told, or not well.
    Limits,
}

/// How large it is, and what the number says.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Size {
    /// The number.
    pub value: f64,
    /// What it says: `factor`, `s`, `samples`, `share ...`.
    pub of: &'static str,
}

/// Samples, and when they were taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stretch {
    /// The first sample.
    pub from: usize,
    /// The last sample.
    pub to: usize,
    /// When the first was taken, s.
    pub from_s: f64,
    /// When the last was taken, s.
    pub to_s: f64,
}

impl Stretch {
    /// These samples of that clock; at least one.
    pub(super) fn of(samples: Range<usize>, clock: &Clock) -> Self {
        let (from, to) = (samples.start, samples.end.max(samples.start + 1) - 1);
        Self { from, to, from_s: clock.time(from), to_s: clock.time(to) }
    }
}

/// Something that is wrong with a signal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignalFinding {
    /// The recording; several, with commas between, where they were looked at together.
    pub recording: String,
    /// The signal.
    pub channel: String,
    /// What is wrong.
    pub what: What,
    /// Where; everywhere where there is none.
    #[serde(rename = "where")]
    pub at: Option<Stretch>,
    /// How large it is.
    pub size: Size,
    /// What follows from it.
    pub consequence: Consequence,
    /// What is wrong, in words.
    pub sentence: String,
    /// What to do.
    pub next: String,
}

impl fmt::Display for SignalFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { recording, sentence, next, .. } = self;
        write!(f, "{recording}: {sentence}; {next}")
    }
}

impl SignalFinding {
    /// Whether nothing can be judged by this recording.
    pub fn forbids(&self) -> bool {
        self.consequence == Consequence::NotJudged
    }
}
