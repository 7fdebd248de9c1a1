//! Why a folder of a campaign does not serve, and what to do.

use std::io;
use std::path::PathBuf;

use drivescope_recording::dataset::DatasetError;
use thiserror::Error;

/// Why a folder of a campaign does not serve.
#[derive(Debug, Error)]
pub enum FolderError {
    /// The folder cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The folder.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A file cannot be written; nothing was left behind.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A file that is damaged.
    #[error("{}: {source}: run the campaign again with --resume, which makes it anew", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: DatasetError,
    },
    /// Parts that are not of one campaign.
    #[error("{}: of another {what} than the rest: remove it, or use a folder for each campaign", path.display())]
    Other {
        /// The file.
        path: PathBuf,
        /// Plan, version or detectors.
        what: &'static str,
    },
    /// There is nothing.
    #[error("{}: no scenarios there: run `campaign PLAN -o` with this folder first", path.display())]
    Nothing {
        /// The folder.
        path: PathBuf,
    },
    /// Scenarios that no part holds.
    #[error(
        "scenarios {missing} are not there, {count} of {of}: run what is left (--resume), then merge"
    )]
    Missing {
        /// Their ranges.
        missing: String,
        /// How many.
        count: u64,
        /// Of how many.
        of: u64,
    },
    /// Scenarios that two parts hold.
    #[error("scenario {scenario} is in two parts, one of them {}: remove one", path.display())]
    Twice {
        /// By its number in the plan.
        scenario: u64,
        /// A part that holds it.
        path: PathBuf,
    },
}
