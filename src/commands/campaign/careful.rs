//! Scenarios that may end the process which runs them: each range in a process of its own, halved
//! until the one that does so is found.

use std::ops::Range;
use std::path::Path;
use std::process::{ExitStatus, Stdio};

use drivescope_scenarios::campaign::{Campaign, Plan, Reader, Rows, write_rows};

use super::folder;
use crate::failure::{Ending, Failure, Stopped, into_report};
use crate::interrupt;

/// Runs the scenarios of a range and writes them as that file: what the other process does.
///
/// # Errors
/// No detectors, or a file that cannot be written.
pub(super) fn part(plan: Plan, file: &Path, range: &Range<u64>) -> miette::Result<Ending> {
    let campaigns = file.parent().and_then(Path::parent).unwrap_or(Path::new(""));
    let campaign = folder::open(plan, campaigns)?;
    let rows = campaign.run(range.clone(), &|_| interrupt::check().is_err());
    let rows = rows.ok_or(Stopped)?;
    write_rows(file, &campaign, range, &rows).map_err(into_report)?;
    Ok(Ending::Done)
}

/// The rows of a range; a scenario that ends its process has the row of one.
///
/// # Errors
/// No process can be started, or the user ends the run.
pub(super) fn rows(
    campaign: &Campaign,
    plan: &Path,
    folder: &Path,
    range: &Range<u64>,
) -> miette::Result<Rows> {
    let unwritable = |source| Failure::Write { path: folder.to_owned(), source };
    let work = tempfile::Builder::new().prefix(interrupt::OWN).tempdir_in(folder);
    let work = work.map_err(unwritable)?;
    let _leftover = interrupt::Leftover::new(work.path());
    let mut rows = Rows::none(campaign.plan());
    // The ranges that are left, the next one last.
    let mut remaining = vec![range.clone()];
    while let Some(range) = remaining.pop() {
        interrupt::check()?;
        let file = work.path().join(format!("{}.parquet", range.start));
        let ended = other_process(plan, &file, &range)?;
        interrupt::check()?;
        if ended.success() {
            let reader = Reader::open(&file).map_err(into_report)?;
            for group in 0..reader.groups() {
                let _ = rows.append(Rows { columns: reader.group(group).map_err(into_report)? });
            }
        } else if ended.code() == Some(Ending::BadInput.code().into()) {
            // Not the scenario's doing: a full disk, a folder that went away.
            return Err(Failure::Usage {
                what: format!("scenarios {} to {} cannot be run", range.start, range.end - 1),
                instead: "see the message above, then give --resume".to_owned(),
            }
            .into());
        } else if range.end - range.start == 1 {
            let _ = rows.append(campaign.aborted(range.start));
        } else {
            let middle = range.start + (range.end - range.start) / 2;
            remaining.extend([middle..range.end, range.start..middle]);
        }
    }
    Ok(rows)
}

fn other_process(plan: &Path, file: &Path, range: &Range<u64>) -> miette::Result<ExitStatus> {
    let failed = |source| Failure::Read { path: "drivescope".into(), source };
    let ended = crate::call::program()
        .map_err(failed)?
        .arg("campaign")
        .arg(plan)
        .arg("--part")
        .arg(format!("{}..{}", range.start, range.end))
        .arg("-o")
        .arg(file)
        .arg("--quiet")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .status()
        .map_err(failed)?;
    Ok(ended)
}
