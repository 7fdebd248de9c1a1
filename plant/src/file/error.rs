//! What can be wrong with a drive file, each with its place and the next step.

use std::fmt;
use std::io;
use std::ops::Range;

use thiserror::Error;

use crate::effects::custom::LawError;
use crate::effects::learned::KnotError;
use crate::effects::refusal::Refusal;
use crate::parameters::meant;

/// Why a drive file was not read or written.
#[derive(Debug, Error)]
pub enum DriveFileError {
    /// The file cannot be read.
    #[error("{file}: cannot be read ({source}): give the path of a drive file in UTF-8")]
    Read { file: String, source: io::Error },
    /// The content is wrong.
    #[error("{place}: {problem}")]
    Content { place: Location, problem: Box<Problem> },
}

impl DriveFileError {
    /// Where in the file, if the error lies in its content.
    pub fn place(&self) -> Option<&Location> {
        match self {
            Self::Content { place, .. } => Some(place),
            Self::Read { .. } => None,
        }
    }

    /// What is wrong with the content.
    pub fn problem(&self) -> Option<&Problem> {
        match self {
            Self::Content { problem, .. } => Some(problem),
            Self::Read { .. } => None,
        }
    }
}

/// Where in a file something stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// File name as it was given.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Bytes of the text that are meant.
    pub span: Range<usize>,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// What is wrong with the content of a drive file. Keys are given with their table.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Problem {
    /// The text is not TOML.
    #[error("not TOML: {reason}")]
    Syntax {
        /// What the TOML parser says.
        reason: String,
    },
    /// A format that this program does not know.
    #[error("`schema` = {found} is unknown: this program reads 1; use a program of that version")]
    Schema {
        /// The number in the file.
        found: i64,
    },
    /// A key that its table does not have.
    #[error("unknown key `{key}`{}; here may stand {known}", meant(.nearest))]
    UnknownKey {
        key: String,
        /// A key of that table that is spelt alike.
        nearest: Option<String>,
        /// The keys of that table.
        known: String,
    },
    /// A key that its table needs.
    #[error("`{key}` is missing: add it{why}")]
    Missing {
        key: String,
        /// What it is needed for, after a comma; may be empty.
        why: String,
    },
    /// A value of another type, or none of the words that are allowed.
    #[error("`{key}` = {found}: it takes {expected}")]
    Type {
        key: String,
        /// The value as the file has it.
        found: String,
        /// What is allowed.
        expected: String,
    },
    /// A number that is not possible.
    #[error("`{key}` = {found:?}: {description}; it takes {allowed}")]
    OutOfRange {
        key: String,
        found: f64,
        /// What the number means.
        description: String,
        /// The range, in words, with the unit.
        allowed: String,
    },
    /// A key that means nothing for this drive.
    #[error("`{key}` has no meaning here: {why}; remove it")]
    Meaningless { key: String, why: &'static str },
    /// An effect that is not in the library.
    #[error("unknown effect `{kind}`{}; known are {known}", meant(.nearest))]
    UnknownEffect {
        /// The kind in the file.
        kind: String,
        /// A kind that is spelt alike.
        nearest: Option<String>,
        /// The kinds there are.
        known: String,
    },
    /// An effect that this drive cannot have.
    #[error("`{id}` cannot exist for this drive: {why}")]
    Impossible {
        id: String,
        /// Why, and what to do.
        why: Refusal,
    },
    /// Two effects that cannot stand in one drive: they are the same part of it.
    #[error(
        "`{id}` cannot stand beside `{other}` (on line {first}): they are one part of the drive; remove one of them"
    )]
    Excluded {
        id: String,
        /// Name of the other.
        other: String,
        /// Line of the other.
        first: usize,
    },
    /// Two effects of one name.
    #[error("a second effect `{id}` (the first is on line {first}): give each its own `id`")]
    Twice {
        id: String,
        /// Line of the first.
        first: usize,
    },
    /// A name that cannot stand in `name.parameter`.
    #[error(
        "`{key}`: `{found}` is no name: it takes a letter or `_`, then letters, digits or `_` (ASCII), and none of {reserved}"
    )]
    Name {
        key: String,
        found: String,
        /// Names that are taken.
        reserved: String,
    },
    /// A typed law that cannot be parsed; the place is the character in the law.
    #[error("`{key}`: {error}")]
    Law {
        key: String,
        /// What is wrong with the law.
        error: LawError,
    },
    /// Knots that make no curve; the place is the knot.
    #[error("`{key}`: {error}")]
    Knots {
        key: String,
        /// What is wrong with the knots.
        error: KnotError,
    },
    /// A learned curve without exactly one value at every knot.
    #[error("`{id}` has {knots} knots and {values} values: give one value at every knot")]
    Values {
        id: String,
        /// Number of knots.
        knots: usize,
        /// Number of values.
        values: usize,
    },
    /// A custom effect with no law or several.
    #[error("`{id}` has {found}: a custom effect gives exactly one of {known}")]
    Laws {
        id: String,
        /// The laws it has, or `no law`.
        found: String,
        /// What a law may give.
        known: String,
    },
    /// A list names a parameter that the drive does not have.
    #[error("`{key}`: the drive has no parameter `{name}`{}; it has {known}", meant(.nearest))]
    UnknownParameter {
        key: String,
        name: String,
        /// A parameter that is spelt alike.
        nearest: Option<String>,
        /// The parameters there are.
        known: String,
    },
    /// A parameter that is fixed and yet free in every recording.
    #[error("`{name}` stands in `fit.fixed` and in `fit.per_recording`: keep one of them")]
    FixedAndFree { name: String },
}

/// A problem with the bytes that it is about; the file's name comes last.
#[derive(Debug)]
pub(super) struct Flaw {
    pub(super) problem: Box<Problem>,
    pub(super) span: Range<usize>,
}

impl Flaw {
    pub(super) fn new(problem: Problem, span: Range<usize>) -> Self {
        Self { problem: Box::new(problem), span }
    }
}
