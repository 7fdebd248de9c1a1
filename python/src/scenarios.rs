//! Scenarios of a campaign, a range at a time: what `drivescope.dask` hands to its workers.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Mutex;

use drivescope::call::campaign::{self, Held, Scenarios as Campaign};
use pyo3::prelude::*;

use crate::{Error, raised};

/// A plan with its detectors.
#[pyclass(frozen, module = "drivescope._drivescope")]
pub(crate) struct Scenarios {
    campaign: Campaign,
    /// Of who drives the campaign: the folder, until it is released.
    held: Mutex<Option<Held>>,
}

#[pymethods]
impl Scenarios {
    /// Of a plan file, with the detectors of that folder, which is held until `release`, or of that text.
    #[staticmethod]
    #[pyo3(signature = (plan, folder, design = None))]
    fn in_folder(
        py: Python<'_>,
        plan: PathBuf,
        folder: PathBuf,
        design: Option<&str>,
    ) -> PyResult<Self> {
        let opened = py.detach(|| Campaign::in_folder(&plan, &folder, design));
        let (campaign, held) = opened.map_err(raised)?;
        Ok(Self { campaign, held: Mutex::new(Some(held)) })
    }

    /// Lets others write in the folder.
    fn release(&self) {
        drop(self.held.lock().map(|mut held| held.take()));
    }

    /// How many there are.
    #[getter]
    fn count(&self) -> u64 {
        self.campaign.count()
    }

    /// Text of the plan.
    #[getter]
    fn plan(&self) -> &str {
        self.campaign.plan()
    }

    /// The drive as the plan names it: one that comes with the package, or a file.
    #[getter]
    fn drive_name(&self) -> &str {
        self.campaign.drive_name()
    }

    /// The FMU that is the machine as the plan names it, where it has one.
    #[getter]
    fn fmu_name(&self) -> Option<&str> {
        self.campaign.fmu_name()
    }

    /// Text of the detectors.
    #[getter]
    fn design(&self) -> PyResult<String> {
        self.campaign.design().map_err(raised)
    }

    /// Digest of plan, drive and detectors.
    #[getter]
    fn digest(&self) -> String {
        self.campaign.digest()
    }

    /// Runs the scenarios from `first` on, without `end`, into a file; the files of the signals that are
    /// kept, where processes of their own wrote them.
    fn run(&self, py: Python<'_>, first: u64, end: u64, file: PathBuf) -> PyResult<Vec<PathBuf>> {
        let range = self.range(first, end)?;
        py.detach(|| self.campaign.run(&range, &file)).map_err(raised)
    }

    /// Writes the row of a scenario that ends the process which runs it.
    fn aborted(&self, py: Python<'_>, scenario: u64, file: PathBuf) -> PyResult<()> {
        self.range(scenario, scenario.saturating_add(1))?;
        py.detach(|| self.campaign.aborted(scenario, &file)).map_err(raised)
    }

    /// Ranges that no file in the folder holds, and files that are damaged, with what is wrong.
    fn missing(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Missing> {
        let (ranges, damaged) = py.detach(|| self.campaign.missing(&folder)).map_err(raised)?;
        Ok((ranges.into_iter().map(|it| (it.start, it.end)).collect(), damaged))
    }

    /// Writes the signals of those scenarios that are kept.
    fn write_traces(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        first: u64,
        end: u64,
        aborted: Vec<u64>,
    ) -> PyResult<()> {
        let range = self.range(first, end)?;
        py.detach(|| self.campaign.write_traces(&folder, &range, &aborted)).map_err(raised)
    }
}

type Missing = (Vec<(u64, u64)>, Vec<(PathBuf, String)>);

impl Scenarios {
    fn range(&self, first: u64, end: u64) -> PyResult<Range<u64>> {
        let all = self.campaign.count();
        if first >= end || end > all {
            return Err(Error::new_err(format!("{first}..{end} is no range of {all} scenarios")));
        }
        Ok(first..end)
    }
}

/// Name of the file of a range.
#[pyfunction]
pub(crate) fn part(first: u64, end: u64) -> String {
    campaign::part(&(first..end))
}

/// Makes one dataset of all files of a folder: its path.
#[pyfunction]
pub(crate) fn merged(py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
    py.detach(|| campaign::merge(&folder)).map_err(raised)
}
