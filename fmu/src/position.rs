//! Where in a document something stands, and what is wrong there.

/// A position in a document, both from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Position {
    pub line: u32,
    /// Column, in characters.
    pub column: u32,
}

/// A problem at a position of a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DocumentProblem {
    pub position: Position,
    /// What is wrong there.
    pub text: String,
}

impl DocumentProblem {
    /// The problem as `file:line:column: what`.
    pub fn in_file(&self, file: &str) -> String {
        let Position { line, column } = self.position;
        format!("{file}:{line}:{column}: {}", self.text)
    }
}
