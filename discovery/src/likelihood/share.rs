//! Shares of changes of a drive: what each adds to the state over a sample.

use super::rows::{LANES, NO_ROWS, Row, Rows};
use super::state::SENSORS;

/// Directions of a pass.
pub(crate) const A_PASS: usize = LANES;

/// Shares of up to [`LANES`] changes over a sample: in the next state, and in what the sensors show
/// now.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    pub(crate) state: Rows,
    pub(crate) shown: [Row; SENSORS],
}

impl Share {
    pub(crate) fn none() -> Self {
        Self { state: NO_ROWS, shown: [[0.0; LANES]; SENSORS] }
    }
}
