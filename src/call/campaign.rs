//! The scenarios of a campaign, a range at a time, for who spreads them over several machines
//! otherwise than by shards: what `campaign` does, in its pieces.

use std::ops::Range;
use std::path::{Path, PathBuf};

use drivescope_scenarios::campaign::{
    self, Campaign, ForeignPlant, Whole, missing, part_name, parts_of, write_rows,
};

use super::{Refused, guarded};
use crate::claim::Claim;
use crate::commands;
use crate::failure::into_report;

/// A plan with its detectors, in a folder.
#[derive(Debug)]
pub struct Scenarios {
    campaign: Campaign,
    plan: PathBuf,
    folder: PathBuf,
}

/// A folder of results in which nobody else writes while this lives.
#[derive(Debug)]
pub struct Held {
    _claim: Claim,
}

/// Ranges that no file of a folder holds, and files that are damaged, with what is wrong.
pub type Missing = (Vec<Range<u64>>, Vec<(PathBuf, String)>);

impl Scenarios {
    /// Those of a plan file, with the detectors of a folder of results, which is held: the text that is
    /// given, those that are there, or new ones.
    ///
    /// # Errors
    /// What is wrong with the plan, or the folder is another run's or another campaign's.
    pub fn in_folder(
        plan: &Path,
        folder: &Path,
        design: Option<&str>,
    ) -> Result<(Self, Held), Refused> {
        guarded(|| {
            let (campaign, claim) = commands::campaign_in(plan, folder, design)?;
            let (plan, folder) = (plan.to_owned(), folder.to_owned());
            Ok((Self { campaign, plan, folder }, Held { _claim: claim }))
        })
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        self.campaign.plan().scenarios()
    }

    /// Text of the plan.
    pub fn plan(&self) -> &str {
        &self.campaign.plan().text
    }

    /// The drive as the plan names it: one that comes with the program, or a file.
    pub fn drive_name(&self) -> &str {
        &self.campaign.plan().drive_name
    }

    /// The FMU that is the machine as the plan names it, where it has one.
    pub fn fmu_name(&self) -> Option<&str> {
        self.campaign.plan().foreign.as_ref().map(ForeignPlant::file)
    }

    /// Text of the detectors.
    ///
    /// # Errors
    /// An internal error only.
    pub fn design(&self) -> Result<String, Refused> {
        guarded(|| self.campaign.design().to_toml().map_err(into_report))
    }

    /// Digest of plan, drive and detectors.
    pub fn digest(&self) -> String {
        format!("{}-{}", self.campaign.plan().digest, self.campaign.design_digest())
    }

    /// Runs those of a range into a file. Those of a foreign FMU run in processes of their own, which write
    /// the signals that are kept into the folder: these files.
    ///
    /// # Errors
    /// It cannot be written.
    ///
    /// # Panics
    /// If the range reaches beyond the scenarios: an internal error.
    pub fn run(&self, range: &Range<u64>, file: &Path) -> Result<Vec<PathBuf>, Refused> {
        let Self { campaign, plan, folder } = self;
        guarded(|| {
            let (rows, traces) = commands::campaign_rows(campaign, plan, folder, range)?;
            write_rows(file, campaign, range, &rows).map_err(into_report)?;
            Ok(traces)
        })
    }

    /// Writes the row of one that ends the process which runs it.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn aborted(&self, scenario: u64, file: &Path) -> Result<(), Refused> {
        let range = scenario..scenario + 1;
        guarded(|| {
            write_rows(file, &self.campaign, &range, &self.campaign.aborted(scenario))
                .map_err(into_report)
        })
    }

    /// What a folder lacks.
    ///
    /// # Errors
    /// Another campaign's folder, or scenarios that are there twice.
    pub fn missing(&self, folder: &Path) -> Result<Missing, Refused> {
        guarded(|| {
            let Whole { parts, damaged } =
                parts_of(folder, Some(&self.campaign)).map_err(into_report)?;
            let ranges = missing(&parts, self.count()).map_err(into_report)?;
            Ok((ranges, damaged.into_iter().map(|(path, why)| (path, why.to_string())).collect()))
        })
    }

    /// Writes the signals of those scenarios of a range that are kept.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn write_traces(
        &self,
        folder: &Path,
        range: &Range<u64>,
        aborted: &[u64],
    ) -> Result<(), Refused> {
        guarded(|| commands::campaign_traces(&self.campaign, folder, range, aborted))
    }
}

/// Name of the file of a range.
pub fn part(range: &Range<u64>) -> String {
    part_name(range)
}

/// Makes one dataset of all files of a folder: its path.
///
/// # Errors
/// What is missing, damaged or of another campaign.
pub fn merge(folder: &Path) -> Result<PathBuf, Refused> {
    guarded(|| Ok(campaign::merge(folder).map_err(into_report)?.0))
}
