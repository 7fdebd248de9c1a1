//! What can be wrong with a plan, each with its place and the next step.

use std::io;
use std::ops::Range;

use drivescope_plant::file::{DriveFileError, Location};
use drivescope_plant::parameters::SetError;
use thiserror::Error;

use crate::experiment::ExperimentError;
use crate::profile::ProfileError;

/// Why a plan was not read.
#[derive(Debug, Error)]
pub enum PlanError {
    /// The file cannot be read.
    #[error("{file}: cannot be read ({source}): give the path of a plan in UTF-8")]
    Read {
        /// Path as it was given.
        file: String,
        /// What the operating system says.
        source: io::Error,
    },
    /// The content is wrong.
    #[error("{place}: {problem}")]
    Content {
        /// File, line and column.
        place: Location,
        /// What is wrong there.
        problem: Box<Problem>,
    },
}

impl PlanError {
    /// Where in the file, if the error lies in its content.
    pub fn place(&self) -> Option<&Location> {
        match self {
            Self::Content { place, .. } => Some(place),
            Self::Read { .. } => None,
        }
    }
}

/// What is wrong with the content of a plan.
#[derive(Debug, Error)]
pub enum Problem {
    /// Not TOML, an unknown key, a missing one, or a value of another type.
    #[error("{reason}")]
    Form {
        /// What the reader says.
        reason: String,
    },
    /// A format that this program does not know.
    #[error("`schema` = {found} is unknown: this program reads 1; use a program of that version")]
    Schema {
        /// The number in the file.
        found: i64,
    },
    /// The drive cannot be read.
    #[error(transparent)]
    Drive(#[from] DriveFileError),
    /// The FMU cannot be read.
    #[error(transparent)]
    Fmu(#[from] Box<drivescope_fmu::import::Error>),
    /// Neither a file nor a built-in drive.
    #[error(
        "`drive` = \"{name}\" is neither a file beside the plan nor a built-in drive ({known})"
    )]
    UnknownDrive {
        /// What was given.
        name: String,
        /// The built-in drives.
        known: String,
    },
    /// The drive does not suit.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A value that says nothing that can be drawn.
    #[error("`{key}`: {what}")]
    Value {
        /// With the tables that it stands in.
        key: String,
        /// What is wrong.
        what: String,
    },
    /// A value that is not possible.
    #[error("`{key}` may be {value}: it takes {allowed}")]
    OutOfRange {
        /// With the tables that it stands in.
        key: String,
        /// The offending end of its range.
        value: f64,
        /// What is possible, in words.
        allowed: String,
    },
    /// The drive has no such parameter, or not such a value of it.
    #[error(transparent)]
    Parameter(#[from] SetError),
    /// No such mechanism.
    #[error("`{key}`: there is no fault `{kind}`; known are none, {known}")]
    Kind {
        /// With the tables that it stands in.
        key: String,
        /// What was given.
        kind: String,
        /// The mechanisms.
        known: String,
    },
    /// No profile.
    #[error("`{key}`: {error}")]
    Profile {
        /// With the tables that it stands in.
        key: String,
        /// Why not.
        error: ProfileError,
    },
    /// A fault that does not end within the run.
    #[error(
        "`{key}` may end at {end_s} s, after the run of {run_s} s: shorten it, begin it earlier, or leave `duration` out (it then lasts to the end)"
    )]
    AfterRun {
        /// The fault.
        key: String,
        /// Its latest end, s.
        end_s: f64,
        /// Length of the run, s.
        run_s: f64,
    },
    /// A fault during the run-up, where nothing is judged.
    #[error(
        "`{key}` may begin at {onset_s} s, within the first {run_up_s} s that are not judged: begin it later, or set detector.run_up"
    )]
    InRunUp {
        /// The fault.
        key: String,
        /// Its earliest begin, s.
        onset_s: f64,
        /// Length of the run-up, s.
        run_up_s: f64,
    },
    /// More scenarios than any campaign.
    #[error(
        "the plan has {count} scenarios ({points} points of the grid, {draws} draws at each): {most} are the most; make the grid coarser or draw less"
    )]
    TooMany {
        /// Scenarios of the plan.
        count: u128,
        /// Points of the grid.
        points: u128,
        /// Draws at each point of the grid.
        draws: u64,
        /// Scenarios that a campaign may have.
        most: u64,
    },
    /// Healthy runs of the design and of the campaign would have one seed.
    #[error(
        "`design.seed` is that of the plan: detectors are designed on other runs than they are judged on"
    )]
    SameSeed,
}

/// A problem with the bytes that it is about.
#[derive(Debug)]
pub(super) struct Flaw {
    pub(super) problem: Box<Problem>,
    pub(super) span: Range<usize>,
}

impl Flaw {
    pub(super) fn new(problem: Problem, span: Range<usize>) -> Self {
        Self { problem: Box::new(problem), span }
    }

    pub(super) fn within(self, file: &str, text: &str) -> PlanError {
        let before = &text.as_bytes()[..self.span.start.min(text.len())];
        let line = before.iter().filter(|byte| **byte == b'\n').count() + 1;
        let from = before.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let column = String::from_utf8_lossy(&before[from..]).chars().count() + 1;
        let place = Location { file: file.to_owned(), line, column, span: self.span };
        PlanError::Content { place, problem: self.problem }
    }
}
