//! A run of a campaign: part by part, each whole or not there.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use drivescope_scenarios::campaign::{
    self, Campaign, DATASET, Plan, Whole, missing, parts_of, write_part,
};
use indicatif::ProgressBar;
use serde::Serialize;

use super::shard::Shard;
use super::{careful, folder};
use crate::claim::Claim;
use crate::failure::{Ending, Failure, StoppedPartWay, into_report};
use crate::interrupt;
use crate::next::Next;
use crate::session::Session;

/// How a campaign is run.
pub(super) struct How {
    pub(super) folder: PathBuf,
    pub(super) shard: Shard,
    pub(super) resume: bool,
}

/// What is said at the end.
#[derive(Debug, Serialize)]
struct CampaignRun {
    plan: String,
    plan_digest: String,
    scenarios: u64,
    shard: String,
    /// Scenarios of this share, and how many of them this run made.
    of_shard: u64,
    made: u64,
    /// Scenarios that ended the process that ran them.
    aborted: Vec<u64>,
    /// The dataset, where it is joined.
    dataset: Option<PathBuf>,
}

/// Between two lines of progress where nobody watches a bar.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Runs what is left of a share.
///
/// # Errors
/// Another run there, another campaign there, what cannot be written, or the user's wish.
pub(super) fn run(plan: Plan, file: &Path, how: &How, session: &Session) -> miette::Result<Ending> {
    let How { folder: place, shard, resume } = how;
    let unwritable = |source| Failure::Write { path: place.clone(), source };
    session.check_writable(&[])?;
    fs::create_dir_all(place).map_err(unwritable)?;
    let _claim = folder::claim(place, *shard)?;
    let spinner = session.spinner();
    spinner.set_message("designing detectors");
    let campaign = folder::open(plan, place)?;
    spinner.finish_and_clear();
    let scenarios = campaign.plan().scenarios();
    let Whole { parts, damaged } = parts_of(place, Some(&campaign)).map_err(into_report)?;
    let there = missing(&parts, scenarios).map_err(into_report)?;
    let mut remaining = Vec::new();
    let mut of_shard = 0;
    for part in shard.parts(scenarios) {
        of_shard += part.end - part.start;
        remaining.extend(there.iter().filter_map(|gap| common(gap, &part)));
    }
    let open: u64 = remaining.iter().map(|range| range.end - range.start).sum();
    if !resume && (open < of_shard || !damaged.is_empty()) {
        let what = format!(
            "{}: {} of {of_shard} scenarios are there already{}",
            place.display(),
            of_shard - open,
            if damaged.is_empty() { "" } else { ", and a part that is cut short" },
        );
        let instead = "go on with --resume, or choose another folder".to_owned();
        return Err(Failure::Usage { what, instead }.into());
    }
    for (path, error) in &damaged {
        session.remark(format_args!("{}: {error}: its scenarios are run again", path.display()));
        fs::remove_file(path).map_err(|source| Failure::Write { path: path.clone(), source })?;
    }
    let mut work = Work {
        bar: session.rates(open, "scenarios"),
        campaign: &campaign,
        file,
        folder: place,
        session,
        began: Instant::now(),
        last: Instant::now(),
        done: 0,
        open,
        aborted: Vec::new(),
    };
    for range in &remaining {
        work.part(range)?;
    }
    work.bar.finish_and_clear();
    let aborted = std::mem::take(&mut work.aborted);
    for scenario in &aborted {
        session.remark(format_args!(
            "scenario {scenario} {}: {}",
            if campaign.plan().foreign.is_some() {
                "has no result (status aborted, column failure)"
            } else {
                "ends the process that runs it (status aborted)"
            },
            Next::new("campaign")
                .with(file.display())
                .options(&format!(" --only {scenario}"))
                .command()
        ));
    }
    let dataset =
        if shard.is_whole() { Some(campaign::merge(place).map_err(into_report)?.0) } else { None };
    let (text, next) = match &dataset {
        Some(dataset) => (
            format!("{scenarios} scenarios, {open} new: {}\n", dataset.display()),
            Next::new("campaign report").with(place.display()),
        ),
        None => (
            format!("share {shard}: {of_shard} of {scenarios} scenarios, {open} new\n"),
            Next::new("campaign merge").with(place.display()),
        ),
    };
    let answer = CampaignRun {
        plan: campaign.plan().name.clone(),
        plan_digest: campaign.plan().digest.clone(),
        scenarios,
        shard: shard.to_string(),
        of_shard,
        made: open,
        aborted,
        dataset,
    };
    session.wrote(&text, &answer, &next)?;
    Ok(Ending::Done)
}

/// What two ranges share.
fn common(a: &Range<u64>, b: &Range<u64>) -> Option<Range<u64>> {
    let both = a.start.max(b.start)..a.end.min(b.end);
    (!both.is_empty()).then_some(both)
}

/// A share that is being run.
struct Work<'a> {
    bar: ProgressBar,
    campaign: &'a Campaign,
    file: &'a Path,
    folder: &'a Path,
    session: &'a Session,
    began: Instant,
    last: Instant,
    done: u64,
    open: u64,
    aborted: Vec<u64>,
}

impl Work<'_> {
    fn part(&mut self, range: &Range<u64>) -> miette::Result<()> {
        let careful = folder::was_interrupted(self.folder, range);
        let mark = Claim::take(self.folder, &folder::mark(range))?;
        let foreign = self.campaign.plan().foreign.is_some();
        let rows = if foreign {
            let bar = &self.bar;
            let done = |more: u64| bar.inc(more);
            let rows =
                careful::rows_of_foreign(self.campaign, self.file, self.folder, range, &done);
            if interrupt::check().is_err() {
                return Err(self.stopped().into());
            }
            rows?
        } else if careful {
            let rows =
                careful::rows(self.campaign, self.file, self.folder, range, &interrupt::asked())?;
            self.bar.inc(range.end - range.start);
            rows
        } else {
            let bar = &self.bar;
            let asked = interrupt::asked();
            let stop = |more: u64| {
                bar.inc(more);
                asked.check().is_err()
            };
            self.campaign.run(range.clone(), &stop).ok_or_else(|| self.stopped())?
        };
        let aborted = rows.aborted();
        if !foreign {
            folder::write_traces(self.campaign, self.folder, range, &aborted)?;
        }
        self.aborted.extend(aborted);
        let _not_now = interrupt::writing();
        write_part(self.folder, self.campaign, range, &rows).map_err(into_report)?;
        drop(mark);
        self.done += range.end - range.start;
        self.tell();
        Ok(())
    }

    /// A line now and then for who reads a log.
    fn tell(&mut self) {
        if self.bar.is_hidden() && self.last.elapsed() > LINE_EVERY {
            let rate = self.done as f64 / self.began.elapsed().as_secs_f64();
            let remaining = (self.open - self.done) as f64 / rate;
            self.session.remark(format_args!(
                "{} of {} scenarios, {rate:.0} a second, {remaining:.0} s left",
                self.done, self.open
            ));
            self.last = Instant::now();
        }
    }

    fn stopped(&self) -> StoppedPartWay {
        StoppedPartWay {
            kept: format!(
                "{} new scenarios are kept in {}, --resume goes on; {DATASET} is not there yet",
                self.done,
                self.folder.display()
            ),
        }
    }
}
