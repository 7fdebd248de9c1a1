//! What is known of a text file before its rows are read.

use super::line::uncommented;

/// Where the header of a text file is, what it says, and what parts the columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// A text for every column, with its unit.
    pub(super) header: Vec<String>,
    /// The names as they stand in the file, so that the header is known where it comes again.
    pub(super) names: Vec<String>,
    pub(super) delimiter: u8,
    /// How many lines that are no comments stand above the header.
    pub(super) above: usize,
    /// Where the header stands among the lines that were looked at.
    pub(super) header_at: usize,
    /// How many of the lines that were looked at come before the rows.
    pub(super) rows_from: usize,
}

impl Layout {
    /// Whether a line is a comment, wherever it stands.
    pub(super) fn is_comment(&self, line: &[u8]) -> bool {
        uncommented(line, self.delimiter).is_some()
    }
}
