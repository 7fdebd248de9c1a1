//! Answers: what a command found, told once.
//!
//! ```text
//!  command ── works ──> answer ──┬── serialises ──────────────────> JSON
//!                                └── is told as blocks ──┬─ text ──> terminal
//!                                                        └─ html ──> page, report
//! ```
//!
//! Sentences and numbers are made where an answer is told as [`block`]s, and nowhere else, so that
//! terminal, page and report cannot contradict each other. What only one of them has room for is
//! marked there with the media that show it.

pub(crate) mod block;
pub(crate) mod compare;
pub(crate) mod diagnose;
pub(crate) mod discover;
pub(crate) mod fit;
pub(crate) mod html;
mod parameters;
pub(crate) mod study;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod text;
pub(crate) mod train;

use drivescope_discovery::signals::SignalFinding;

use crate::read_evidence::KnownNoise;
use crate::report::words::{given, number};
use block::{ALL, Block, Fact};

pub(crate) use parameters::{not_told, parameters};
pub(crate) use text::{line, text};

/// What makes every number below worthless: remarks may have been left out.
pub(crate) fn unusable(signals: &[SignalFinding]) -> Vec<Block> {
    let forbids = signals.iter().filter(|it| it.forbids());
    forbids.map(|it| Block::Alert(format!("not to be judged: {it}"))).collect()
}

/// How the model ran.
fn run(observer_hz: f64) -> Fact {
    let how = match observer_hz {
        0.0 => "free, from u".to_owned(),
        hz => format!("with an observer of {} Hz, frozen", given(hz)),
    };
    Fact::new(ALL, "Model runs", how)
}

/// The noise of an output; of that recording, where there are several.
fn noise(it: &KnownNoise, recording: &str) -> Fact {
    let of = if recording.is_empty() { String::new() } else { format!(" in {recording}") };
    let value = format!("{} {}", number(it.sd), it.unit);
    let source = format!("{:?}", it.source).to_lowercase();
    Fact::new(ALL, format!("Noise of {}{of}", it.name), value).note(source)
}

/// What to call a drive.
pub(crate) fn named(drive: &str) -> String {
    if drive.is_empty() { "the drive" } else { drive }.to_owned()
}
