//! What the work of a session rests on.

use std::sync::Arc;

use drivescope_discovery::Evidence;

use super::command_line::Files;
use super::progress::Progress;
use crate::evidence::Gathered;

/// Copies that nobody changes.
#[derive(Debug, Clone)]
pub(super) struct Basis {
    /// The recordings, parted.
    pub(super) gathered: Arc<Gathered>,
    /// The recordings, whole.
    pub(super) whole: Arc<Evidence>,
    /// How the recordings are named on a command line.
    pub(super) files: Files,
    pub(super) seed: u64,
}

impl Basis {
    /// Of a session whose recordings were analysed.
    pub(super) fn of(progress: &Progress) -> miette::Result<Self> {
        let state = progress.bench.state();
        let missing = || miette::Report::msg("analyse a recording first");
        Ok(Self {
            gathered: state.gathered.clone().ok_or_else(missing)?,
            whole: state.whole.clone().ok_or_else(missing)?,
            files: Files::of(&state.recordings, progress.bench.seed),
            seed: progress.bench.seed,
        })
    }
}
