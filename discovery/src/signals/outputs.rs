//! The outputs that checks look at one by one.

use crate::estimate::Evidence;
use crate::measured::{Channel, Measured};

/// Every output of every recording, with its recording.
pub(super) fn outputs(evidence: &Evidence) -> impl Iterator<Item = (&Measured, &Channel)> {
    evidence.recordings.iter().flat_map(|it| it.outputs.iter().map(move |y| (it, y)))
}
