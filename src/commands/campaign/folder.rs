//! The folder of a campaign: its detectors, marks of what is being made, and traces.

use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use drivescope_scenarios::campaign::{Campaign, Design, Plan};

use super::shard::Shard;
use crate::claim::Claim;
use crate::failure::{Failure, into_report};
use crate::output;

/// Detectors of the campaign; the underscore hides it from readers of datasets.
const DESIGN: &str = "_design.toml";
/// Folder of signals that are kept.
const TRACES: &str = "traces";
/// Beginning of the marks of runs and of parts.
const RUNS: &str = ".drivescope-running";
const RUNNING: &str = ".running-";

/// Marks that the folder is at work for that share, if nobody else is.
///
/// # Errors
/// Another run has the share, or the whole.
pub(super) fn claim(folder: &Path, shard: Shard) -> miette::Result<Claim> {
    let name = |shard: Shard| match shard.is_whole() {
        true => RUNS.to_owned(),
        false => format!("{RUNS}-{}", shard.to_string().replace('/', "-of-")),
    };
    let own = name(shard);
    let claim = Claim::take(folder, &own)?;
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let other = entry.file_name().to_string_lossy().into_owned();
        // Shares stand beside each other, the whole beside none.
        let meets = other.starts_with(RUNS) && (shard.is_whole() || other == RUNS);
        if other == own || !meets {
            continue;
        }
        if let Some(by) = Claim::holder(&entry.path()) {
            return Err(Failure::Usage {
                what: format!("{}: another run writes there (process {by})", folder.display()),
                instead: format!(
                    "wait for it, or remove {} if that run is no more",
                    entry.path().display()
                ),
            }
            .into());
        }
    }
    Ok(claim)
}

/// The campaign of that plan with the detectors of the folder, which are designed if there are none.
///
/// # Errors
/// The folder is that of another plan or version, or no detectors can be designed.
pub(super) fn open(plan: Plan, folder: &Path) -> miette::Result<Campaign> {
    let path = folder.join(DESIGN);
    if path.is_file() {
        let text = fs::read_to_string(&path)
            .map_err(|source| Failure::Read { path: path.clone(), source })?;
        let design = Design::parse(&text).map_err(into_report)?;
        let other = match (design.plan == plan.digest, design.version == version()) {
            (true, true) => return Ok(Campaign::new(plan, design)),
            (false, _) => "of another plan".to_owned(),
            (true, false) => format!("of version {}, this is {}", design.version, version()),
        };
        return Err(Failure::Usage {
            what: format!("{}: the campaign there is {other}", folder.display()),
            instead: "use a folder for each plan and version".to_owned(),
        }
        .into());
    }
    let design = Design::new(&plan).map_err(into_report)?;
    put_design(folder, &design.to_toml().map_err(into_report)?)?;
    Ok(Campaign::new(plan, design))
}

/// Puts the text of detectors into the folder.
///
/// # Errors
/// It cannot be written.
pub(super) fn put_design(folder: &Path, text: &str) -> miette::Result<()> {
    Ok(output::write_file(&folder.join(DESIGN), |out| out.write_all(text.as_bytes()))?)
}

/// Version of this program.
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// The mark of a part that is being made.
pub(super) fn mark(range: &Range<u64>) -> String {
    format!("{RUNNING}{}-{}", range.start, range.end)
}

/// Whether a run that is no more was at that part.
pub(super) fn was_interrupted(folder: &Path, range: &Range<u64>) -> bool {
    let mark = folder.join(mark(range));
    mark.exists() && Claim::holder(&mark).is_none()
}

/// Writes the signals of those scenarios of a range that are kept and do not end the process.
///
/// # Errors
/// They cannot be written.
pub(crate) fn write_traces(
    campaign: &Campaign,
    folder: &Path,
    range: &Range<u64>,
    aborted: &[u64],
) -> miette::Result<()> {
    let runs = range.clone().filter(|k| !aborted.contains(k));
    let kept: Vec<u64> = runs.filter(|k| campaign.plan().keeps_trace(*k)).collect();
    if kept.is_empty() {
        return Ok(());
    }
    let traces = folder.join(TRACES);
    fs::create_dir_all(&traces)
        .map_err(|source| Failure::Write { path: traces.clone(), source })?;
    for scenario in kept {
        let signals = campaign.trace(scenario).map_err(into_report)?;
        output::write_recording(&trace(&traces, scenario), &signals)?;
    }
    Ok(())
}

/// The signals of a range that are there.
pub(super) fn traces_of(folder: &Path, range: &Range<u64>) -> Vec<PathBuf> {
    let traces = folder.join(TRACES);
    range.clone().map(|scenario| trace(&traces, scenario)).filter(|path| path.is_file()).collect()
}

fn trace(folder: &Path, scenario: u64) -> PathBuf {
    // Parquet by another ending: who reads the rows of the folder does not meet the signals.
    folder.join(format!("scenario-{scenario:09}.pq"))
}
