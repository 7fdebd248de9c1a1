//! Files of a campaign: parts of some scenarios each, and the one dataset that they make.
//!
//! A part is whole or not there; it says which scenarios it holds, of which plan, judged by which
//! detectors, made by which version. The merged dataset has row groups of one size whatever the parts
//! were: its bytes do not tell how the work was split.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use drivescope_recording::dataset::{DatasetError, Reader, Writer};
use drivescope_recording::write_whole;
use thiserror::Error;

use super::Campaign;
use super::rows::Rows;

/// The merged dataset.
pub const DATASET: &str = "campaign.parquet";
/// Rows of a group of it.
const GROUP: usize = 8192;
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
        /// The scenario.
        scenario: u64,
        /// A part that holds it.
        path: PathBuf,
    },
}

/// A file with the rows of some scenarios.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Where it is.
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

/// Scenarios that no part holds, of all.
///
/// # Errors
/// [`FolderError::Twice`].
pub fn missing(parts: &[Part], scenarios: u64) -> Result<Vec<Range<u64>>, FolderError> {
    let (mut missing, mut next) = (Vec::new(), 0);
    for part in parts {
        if part.range.start < next {
            let (scenario, path) = (part.range.start, part.path.clone());
            return Err(FolderError::Twice { scenario, path });
        }
        if part.range.start > next {
            missing.push(next..part.range.start);
        }
        next = part.range.end;
    }
    if next < scenarios {
        missing.push(next..scenarios);
    }
    Ok(missing)
}

/// Makes one dataset of all parts of a folder and removes them; its path, and its scenarios.
///
/// # Errors
/// [`FolderError`]: what is missing, twice, damaged or of another campaign; nothing is removed then.
pub fn merge(folder: &Path) -> Result<(PathBuf, u64), FolderError> {
    let Whole { mut parts, damaged } = parts_of(folder, None)?;
    let dataset = folder.join(DATASET);
    let scenarios = parts.first().map_or(0, Part::scenarios);
    let complete = |part: &Part| part.path == dataset && part.range == (0..scenarios);
    if parts.iter().any(complete) {
        // A merge that was ended after its dataset was in place.
        remove(parts.iter().filter(|part| !complete(part)));
        return Ok((dataset, scenarios));
    }
    if let Some((path, source)) = damaged.into_iter().next() {
        return Err(FolderError::Damaged { path, source });
    }
    parts.retain(|part| part.path != dataset);
    let first = parts.first().ok_or_else(|| FolderError::Nothing { path: folder.to_owned() })?;
    let gaps = missing(&parts, scenarios)?;
    if !gaps.is_empty() {
        let count = gaps.iter().map(|gap| gap.end - gap.start).sum();
        let words: Vec<String> =
            gaps.iter().take(5).map(|gap| format!("{}..{}", gap.start, gap.end)).collect();
        let more = if gaps.len() > words.len() { ", ..." } else { "" };
        let missing = format!("{}{more}", words.join(", "));
        return Err(FolderError::Missing { missing, count, of: scenarios });
    }
    let said = with_range(&first.said, &(0..scenarios));
    let mut failed = None;
    let written = write_whole(&dataset, |out| {
        joined(out, &parts, &said).map_err(|error| match error {
            Join::Folder(error) => {
                let text = error.to_string();
                failed = Some(error);
                io::Error::other(text)
            }
            Join::Dataset(error) => io::Error::other(error),
        })
    });
    if let Some(error) = failed {
        return Err(error);
    }
    written.map_err(|source| FolderError::Write { path: dataset.clone(), source })?;
    remove(parts.iter());
    Ok((dataset, scenarios))
}

fn remove<'a>(parts: impl Iterator<Item = &'a Part>) {
    for part in parts {
        // What stays is found in the dataset, too, and goes with the next merge.
        let _ = std::fs::remove_file(&part.path);
    }
}

enum Join {
    Folder(FolderError),
    Dataset(DatasetError),
}

fn joined(
    out: &mut (dyn io::Write + Send),
    parts: &[Part],
    said: &[(String, String)],
) -> Result<(), Join> {
    let mut open: Option<(Writer<_>, Rows)> = None;
    let mut out = Some(out);
    for part in parts {
        let mut taken = Vec::new();
        part.rows(&mut |rows| {
            taken.push(rows);
            Ok(())
        })
        .map_err(Join::Folder)?;
        for rows in taken {
            match &mut open {
                Some((_, waiting)) => {
                    if !waiting.append(rows) {
                        let (path, what) = (part.path.clone(), "set of columns");
                        return Err(Join::Folder(FolderError::Other { path, what }));
                    }
                }
                None => {
                    let Some(out) = out.take() else { break };
                    let writer = Writer::new(out, &rows.columns, said).map_err(Join::Dataset)?;
                    open = Some((writer, rows));
                }
            }
            if let Some((writer, waiting)) = &mut open {
                while waiting.len() >= GROUP {
                    let group = waiting.split_front(GROUP);
                    writer.group(&group.columns).map_err(Join::Dataset)?;
                }
            }
        }
    }
    if let Some((mut writer, waiting)) = open {
        if !waiting.is_empty() {
            writer.group(&waiting.columns).map_err(Join::Dataset)?;
        }
        writer.finish().map_err(Join::Dataset)?;
    }
    Ok(())
}
