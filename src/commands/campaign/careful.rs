//! Scenarios that may end the process which runs them: each range in a process of its own, halved
//! until the one that does so is found. Those of a foreign FMU are always run so, and one that takes too
//! long is given up.

use std::fs;
use std::ops::Range;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use drivescope_scenarios::campaign::{Campaign, ForeignPlant, Plan, Reader, Rows, write_rows};
use rayon::prelude::*;

use super::folder;
use super::watched::{self, Ended, Progress};
use crate::failure::{Ending, Failure, Stopped, into_report};
use crate::interrupt::{self, Asked};

/// Runs the scenarios of a range and writes them as that file: what the other process does.
///
/// # Errors
/// No detectors, or a file that cannot be written.
pub(super) fn part(plan: Plan, file: &Path, range: &Range<u64>) -> miette::Result<Ending> {
    let campaigns = file.parent().and_then(Path::parent).unwrap_or(Path::new(""));
    let campaign = folder::open(plan, campaigns)?;
    let foreign = campaign.plan().foreign.is_some();
    let unwritable = |source| Failure::Write { path: file.to_owned(), source };
    let progress = foreign.then(|| Progress::begin(file)).transpose().map_err(unwritable)?;
    let stop = |_| {
        if let Some(progress) = &progress {
            progress.one_more();
        }
        interrupt::check().is_err()
    };
    let rows = campaign.run(range.clone(), &stop).ok_or(Stopped)?;
    if foreign {
        // No other process is to load what this one survived.
        folder::write_traces(&campaign, campaigns, range, &rows.aborted())?;
    }
    write_rows(file, &campaign, range, &rows).map_err(into_report)?;
    Ok(Ending::Done)
}

/// Scenarios of a foreign FMU that a process runs: what it takes to start one does not tell.
const AT_ONCE: u64 = 64;

/// The rows of a range of scenarios whose machine is a foreign FMU, and their signals where those are
/// kept; one process a thread, and `done` hears of each that is over.
///
/// # Errors
/// As [`rows`].
pub(super) fn rows_of_foreign(
    campaign: &Campaign,
    plan: &Path,
    folder: &Path,
    range: &Range<u64>,
    done: &(dyn Fn(u64) + Sync),
) -> miette::Result<Rows> {
    let asked = interrupt::asked();
    let some = |first: u64| {
        asked.check()?;
        let some = first..(first + AT_ONCE).min(range.end);
        let rows = rows(campaign, plan, folder, &some, &asked);
        done(some.end - some.start);
        rows
    };
    let firsts: Vec<u64> = range.clone().step_by(AT_ONCE as usize).collect();
    let made: Vec<Rows> = firsts.into_par_iter().map(some).collect::<miette::Result<_>>()?;
    let mut rows = Rows::none(campaign.plan());
    for more in made {
        let _ = rows.append(more);
    }
    Ok(rows)
}

/// What is to be done for the rows of a range.
enum Remaining {
    Run(Range<u64>),
    /// The row of a scenario that took too long.
    GiveUp(u64),
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
    asked: &Asked,
) -> miette::Result<Rows> {
    let unwritable = |source| Failure::Write { path: folder.to_owned(), source };
    let work = tempfile::Builder::new().prefix(interrupt::OWN).tempdir_in(folder);
    let work = work.map_err(unwritable)?;
    let _leftover = interrupt::Leftover::new(work.path());
    let mut rows = Rows::none(campaign.plan());
    // What is left, the next one last.
    let mut remaining = vec![Remaining::Run(range.clone())];
    while let Some(next) = remaining.pop() {
        let range = match next {
            Remaining::Run(range) if range.is_empty() => continue,
            Remaining::Run(range) => range,
            Remaining::GiveUp(scenario) => {
                let _ = rows.append(campaign.given_up(scenario));
                continue;
            }
        };
        asked.check()?;
        let file = work.path().join(format!("{}.parquet", range.start));
        let limit = campaign.plan().foreign.as_ref().map(ForeignPlant::time_limit);
        let ended = match other_process((plan, limit), &file, &range, asked)? {
            Ended::Alone(status) => status,
            Ended::TookTooLong { after } => {
                let scenario = range.start + after;
                remaining.extend([
                    Remaining::Run(scenario + 1..range.end),
                    Remaining::GiveUp(scenario),
                    Remaining::Run(range.start..scenario),
                ]);
                continue;
            }
        };
        asked.check()?;
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
            remaining.extend([middle..range.end, range.start..middle].map(Remaining::Run));
        }
    }
    Ok(rows)
}

fn other_process(
    (plan, limit): (&Path, Option<Duration>),
    file: &Path,
    range: &Range<u64>,
    asked: &Asked,
) -> miette::Result<Ended> {
    let failed = |source| Failure::Read { path: "drivescope".into(), source };
    let mut program = crate::call::program().map_err(failed)?;
    if let Some(work) = file.parent().filter(|_| limit.is_some()) {
        // What an FMU unpacked there goes with the folder, however its process ends.
        program.env("TMPDIR", fs::canonicalize(work).map_err(failed)?);
        program.env("RAYON_NUM_THREADS", "1");
    }
    program
        .arg("campaign")
        .arg(plan)
        .arg("--part")
        .arg(format!("{}..{}", range.start, range.end))
        .arg("-o")
        .arg(file)
        .arg("--quiet")
        .stdin(Stdio::null())
        .stdout(Stdio::null());
    let Some(limit) = limit else {
        return Ok(Ended::Alone(program.status().map_err(failed)?));
    };
    let mut child = program.spawn().map_err(failed)?;
    let ended = watched::wait(&mut child, (file, range.end - range.start), limit, asked);
    Ok(ended.map_err(failed)?.ok_or(Stopped)?)
}
