//! `campaign`: many scenarios of a plan, a row each.
//!
//! Files of the folder: `campaign.parquet`, one row a scenario, or before a merge `part-*.parquet`;
//! `traces/scenario-*.pq`, the signals that are kept; `_design.toml`, the detectors. A part that is
//! being made has a mark `.running-FIRST-LAST`: where one is left by a run that is no more, its
//! scenarios are run by processes of their own (`careful`).

mod careful;
mod folder;
mod merge;
mod only;
mod report;
mod run;
mod shard;
mod watched;

use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use drivescope_scenarios::campaign::{Campaign as Scenarios, Plan, PlanError, Rows};
use miette::{Diagnostic, NamedSource, SourceSpan};
use thiserror::Error;

pub(crate) use self::folder::write_traces as campaign_traces;
use self::shard::Shard;
use super::Run;
use crate::claim::Claim;
use crate::failure::{Ending, Failure, Stopped, visible};
use crate::interrupt;
use crate::session::Session;

/// Run many faulty scenarios of a plan: one row each, as Parquet.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Campaign {
    /// Plan of the scenarios (.toml); a small one ships as scenarios/plans/quick.toml.
    #[arg(required = true)]
    plan: Option<PathBuf>,
    /// Folder for the results; several shards may share it.
    #[arg(short, long, value_name = "DIR", required_unless_present = "only")]
    output: Option<PathBuf>,
    /// Run one of N shares of the scenarios, as on several machines; `campaign merge DIR` joins them.
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE, hide_default_value = true)]
    shard: Shard,
    /// Go on with what an earlier run has left.
    #[arg(long)]
    resume: bool,
    /// Run this scenario alone and print its row; with -o, its signals go to that recording.
    #[arg(long, value_name = "K", conflicts_with_all = ["shard", "resume"])]
    only: Option<u64>,
    /// Run these scenarios into that part (what a run starts for scenarios that end processes).
    #[arg(long, value_name = "FIRST..LAST", hide = true)]
    part: Option<shard::Scenarios>,
    #[command(subcommand)]
    then: Option<Then>,
}

/// What becomes of results.
#[derive(Debug, Subcommand)]
enum Then {
    /// Join the parts of a folder to one dataset.
    Merge(merge::Merge),
    /// Sum up what a campaign found: tables and a page.
    Report(report::Report),
}

impl Run for Campaign {
    fn run(self, session: &Session) -> miette::Result<Ending> {
        if let Some(then) = self.then {
            return match then {
                Then::Merge(merge) => merge.run(session),
                Then::Report(report) => report.run(session),
            };
        }
        let path = self.plan.unwrap_or_default();
        let plan = read(&path)?;
        if let Some(seed) = session.given_seed.filter(|seed| *seed != plan.seed) {
            return Err(Failure::Usage {
                what: format!("--seed {seed}: the plan says seed = {}", plan.seed),
                instead: "change the seed in the plan: it is a part of what its results say"
                    .to_owned(),
            }
            .into());
        }
        match (self.only, self.part, self.output) {
            (Some(scenario), ..) if scenario >= plan.scenarios() => Err(Failure::Usage {
                what: format!("--only {scenario}: the plan has {} scenarios", plan.scenarios()),
                instead: "they are numbered from 0".to_owned(),
            }
            .into()),
            (Some(scenario), _, output) => only::only(plan, &path, scenario, output, session),
            (None, Some(part), Some(output)) => careful::part(plan, &output, &part.0),
            (None, None, Some(output)) => {
                let how = run::How { folder: output, shard: self.shard, resume: self.resume };
                run::run(plan, &path, &how, session)
            }
            (None, _, None) => Err(Failure::Usage {
                what: "there is no folder for the results".to_owned(),
                instead: "give one with -o DIR".to_owned(),
            }
            .into()),
        }
    }
}

/// The campaign of a plan file in a folder that is made and claimed, for who runs its parts otherwise;
/// with the detectors of that text, where one is given.
///
/// # Errors
/// A plan that is wrong, or a folder of another run or campaign.
pub(crate) fn campaign_in(
    plan: &Path,
    folder: &Path,
    design: Option<&str>,
) -> miette::Result<(Scenarios, Claim)> {
    let plan = read(plan)?;
    std::fs::create_dir_all(folder)
        .map_err(|source| Failure::Write { path: folder.to_owned(), source })?;
    let claim = folder::claim(folder, Shard::WHOLE)?;
    if let Some(design) = design {
        folder::put_design(folder, design)?;
    }
    Ok((folder::open(plan, folder)?, claim))
}

/// The rows of a range for who runs it otherwise, and the signals that are kept where the machine is a
/// foreign FMU: processes of their own write them into the folder.
///
/// # Errors
/// No process can be started, or the user ends the run.
pub(crate) fn campaign_rows(
    campaign: &Scenarios,
    plan: &Path,
    folder: &Path,
    range: &Range<u64>,
) -> miette::Result<(Rows, Vec<PathBuf>)> {
    if campaign.plan().foreign.is_some() {
        let rows = careful::rows(campaign, plan, folder, range, &interrupt::asked())?;
        return Ok((rows, folder::traces_of(folder, range)));
    }
    let rows = campaign.run(range.clone(), &|_| interrupt::check().is_err()).ok_or(Stopped)?;
    Ok((rows, Vec::new()))
}

/// A plan that is wrong, with the text around the place.
#[derive(Debug, Error, Diagnostic)]
#[error("{error}")]
struct WrongPlan {
    error: PlanError,
    #[source_code]
    text: NamedSource<String>,
    #[label("here")]
    span: Option<SourceSpan>,
}

/// The plan of a file.
///
/// # Errors
/// A file that cannot be read, or wrong content, with its place.
fn read(path: &Path) -> miette::Result<Plan> {
    Plan::read(path).map_err(|error| {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let span = error.place().and_then(|place| visible(&text, place.span.clone()));
        let text = NamedSource::new(path.display().to_string(), text).with_language("toml");
        WrongPlan { error, text, span }.into()
    })
}
