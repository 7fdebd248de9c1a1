//! One dataset of many parts: all scenarios, each once, in row groups of one size.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use drivescope_recording::dataset::{DatasetError, Writer};
use drivescope_recording::write_whole;

use super::super::rows::Rows;
use super::{DATASET, FolderError, Part, Whole, parts_of, with_range};

/// Rows of a group of the dataset.
const GROUP: usize = 8192;

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
