//! Counts that must not be zero.

use crate::failure::Failure;

/// Refuses options of which one says 0.
pub(super) fn all_positive(counts: &[(&str, u64)], usual: &str) -> Result<(), Failure> {
    if counts.iter().all(|(_, count)| *count > 0) {
        return Ok(());
    }
    let given: Vec<String> =
        counts.iter().map(|(option, count)| format!("--{option} {count}")).collect();
    Err(Failure::Usage {
        what: format!("{}: nothing to judge", given.join(" ")),
        instead: format!("give 1 or more{usual}"),
    })
}
