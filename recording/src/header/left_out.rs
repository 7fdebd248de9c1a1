//! Columns that a recording does without.

/// Columns that are left out.
#[derive(Debug, Default)]
pub(crate) struct LeftOut {
    /// Their positions in the table, rising.
    pub(crate) columns: Vec<usize>,
    /// What they are, a phrase for each name.
    pub(crate) said: Vec<String>,
}
