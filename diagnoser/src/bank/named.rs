//! What is kept of a fault that was named, so that later rows can weigh its name again.

use crate::memory::{Memory, MemoryError, Walk};

/// A fault that was named after health: the rows from which it is known stay, for those that follow
/// may tell that another mechanism grew.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Named {
    /// First row at which it acted.
    pub(crate) onset: usize,
    /// The beliefs before rows up to this one, exclusive, are those of no fault.
    pub(crate) healthy: usize,
    /// First row after it was named, whose belief and all later ones hold it.
    pub(crate) since: usize,
    /// Logarithm of the likelihood that it gains over no fault: of all rows before it was named, over
    /// those whose beliefs are healthy.
    pub(crate) gain: f64,
}

impl Named {
    /// The same with its rows counted otherwise.
    pub(crate) fn counted(self, row: impl Fn(usize) -> usize) -> Self {
        let Self { onset, healthy, since, gain } = self;
        Self { onset: row(onset), healthy: row(healthy), since: row(since), gain }
    }
}

impl Memory for Named {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each([&mut self.onset, &mut self.healthy, &mut self.since])?;
        self.gain.walk(walk)
    }
}
