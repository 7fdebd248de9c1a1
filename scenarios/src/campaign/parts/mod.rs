//! Files of a campaign: parts of some scenarios each, and the one dataset that they make.
//!
//! A part is whole or not there; it says which scenarios it holds, of which plan, judged by which
//! detectors, made by which version. The merged dataset has row groups of one size whatever the parts
//! were: its bytes do not tell how the work was split.

mod error;
mod merge;

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use drivescope_recording::dataset::{DatasetError, Reader, Writer};
use drivescope_recording::write_whole;

use super::Campaign;
use super::rows::Rows;
pub use error::FolderError;
pub use merge::{merge, missing};

/// The merged dataset.
pub const DATASET: &str = "campaign.parquet";
/// How names of parts begin and end.
const PREFIX: &str = "part-";
const SUFFIX: &str = ".parquet";
/// What is said of a dataset.
const PLAN: &str = "drivescope.plan";
const PLAN_DIGEST: &str = "drivescope.plan_digest";
const DESIGN_DIGEST: &str = "drivescope.design_digest";
const VERSION: &str = "drivescope.version";
const SCENARIOS: &str = "drivescope.scenarios";
const FIRST: &str = "drivescope.first";
const LAST: &str = "drivescope.last";
const SAID: [&str; 5] = [PLAN, PLAN_DIGEST, DESIGN_DIGEST, VERSION, SCENARIOS];

/// A file with the rows of some scenarios.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Of the Parquet file.
    pub path: PathBuf,
    /// Scenarios that it holds.
    pub range: Range<u64>,
    said: Vec<(String, String)>,
}

/// What is in a folder of a campaign.
#[derive(Debug, Default)]
pub struct Whole {
    /// Parts, or the merged dataset, in the order of their scenarios.
    pub parts: Vec<Part>,
    /// Parts that are cut short or damaged, and what is wrong.
    pub damaged: Vec<(PathBuf, DatasetError)>,
}

/// The name of a part.
pub fn part_name(range: &Range<u64>) -> String {
    format!("{PREFIX}{:09}-{:09}{SUFFIX}", range.start, range.end)
}

/// Writes the rows of a range of scenarios into a folder, whole or not at all.
///
/// # Errors
/// [`FolderError::Write`].
pub fn write_part(
    folder: &Path,
    campaign: &Campaign,
    range: &Range<u64>,
    rows: &Rows,
) -> Result<PathBuf, FolderError> {
    let path = folder.join(part_name(range));
    write_rows(&path, campaign, range, rows)?;
    Ok(path)
}

/// The same into that file.
///
/// # Errors
/// [`FolderError::Write`].
pub fn write_rows(
    path: &Path,
    campaign: &Campaign,
    range: &Range<u64>,
    rows: &Rows,
) -> Result<(), FolderError> {
    let said = said(campaign);
    let written = |out: &mut (dyn io::Write + Send)| -> Result<(), DatasetError> {
        let mut writer = Writer::new(out, &rows.columns, &with_range(&said, range))?;
        writer.group(&rows.columns)?;
        writer.finish()
    };
    write_whole(path, |out| written(out).map_err(io::Error::other))
        .map_err(|source| FolderError::Write { path: path.to_owned(), source })
}

fn said(campaign: &Campaign) -> Vec<(String, String)> {
    let plan = campaign.plan();
    let values = [
        plan.text.clone(),
        plan.digest.clone(),
        campaign.design_digest().to_owned(),
        env!("CARGO_PKG_VERSION").to_owned(),
        plan.scenarios().to_string(),
    ];
    SAID.map(str::to_owned).into_iter().zip(values).collect()
}

fn with_range(said: &[(String, String)], range: &Range<u64>) -> Vec<(String, String)> {
    let ends = [(FIRST, range.start), (LAST, range.end)];
    let ends = ends.map(|(key, value)| (key.to_owned(), value.to_string()));
    said.iter().cloned().chain(ends).collect()
}

/// What is in a folder: the merged dataset where there is one, else its parts. Those that are of
/// another campaign than that one, if one is given, or than each other, are refused.
///
/// # Errors
/// [`FolderError::Read`], [`FolderError::Other`].
pub fn parts_of(folder: &Path, of: Option<&Campaign>) -> Result<Whole, FolderError> {
    let unreadable = |source| FolderError::Read { path: folder.to_owned(), source };
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name();
        let name = name.to_string_lossy().into_owned();
        if name == DATASET || name.starts_with(PREFIX) && name.ends_with(SUFFIX) {
            names.push(name);
        }
    }
    names.sort_unstable();
    let mut whole = Whole::default();
    let mut expected = of.map(said);
    for name in names {
        let path = folder.join(name);
        let part = match read_part(&path) {
            Ok(part) => part,
            Err(error) => {
                whole.damaged.push((path, error));
                continue;
            }
        };
        let expected = expected.get_or_insert_with(|| part.said.clone());
        let kinds = ["plan", "plan", "set of detectors", "version", "plan"];
        for ((own, other), what) in part.said.iter().zip(expected.iter()).zip(kinds) {
            // The words of a plan may differ where its meaning does not.
            if own.0 != PLAN && own != other {
                return Err(FolderError::Other { path, what });
            }
        }
        whole.parts.push(part);
    }
    whole.parts.sort_by_key(|part| (part.range.start, part.range.end));
    Ok(whole)
}

fn read_part(path: &Path) -> Result<Part, DatasetError> {
    let reader = Reader::open(path)?;
    let word = |key: &str| reader.said(key).unwrap_or("").to_owned();
    let number = |key: &str| word(key).parse::<u64>().ok();
    let range = number(FIRST).zip(number(LAST)).map(|(first, last)| first..last);
    let range = range.filter(|it| it.end.saturating_sub(it.start) == reader.rows() as u64);
    let range = range.ok_or_else(|| DatasetError::Kind { name: FIRST.to_owned() })?;
    let said = SAID.iter().map(|key| ((*key).to_owned(), word(key))).collect();
    Ok(Part { path: path.to_owned(), range, said })
}

impl Part {
    /// Number of scenarios of the whole campaign.
    pub fn scenarios(&self) -> u64 {
        self.value(SCENARIOS).parse().unwrap_or(0)
    }

    /// The text of the plan.
    pub fn plan(&self) -> &str {
        self.value(PLAN)
    }

    /// Digest of the plan.
    pub fn plan_digest(&self) -> &str {
        self.value(PLAN_DIGEST)
    }

    /// Version of the program that made it.
    pub fn version(&self) -> &str {
        self.value(VERSION)
    }

    fn value(&self, key: &str) -> &str {
        self.said.iter().find(|(known, _)| known == key).map_or("", |(_, value)| value)
    }

    /// Hands out its rows, some at a time.
    ///
    /// # Errors
    /// [`FolderError::Damaged`], or what `take` answers.
    pub fn rows(
        &self,
        take: &mut dyn FnMut(Rows) -> Result<(), FolderError>,
    ) -> Result<(), FolderError> {
        let damaged = |source| FolderError::Damaged { path: self.path.clone(), source };
        let reader = Reader::open(&self.path).map_err(damaged)?;
        for group in 0..reader.groups() {
            take(Rows { columns: reader.group(group).map_err(damaged)? })?;
        }
        Ok(())
    }
}
