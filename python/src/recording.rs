//! A recording whose signals are numpy's arrays.
//!
//! The arrays own the values and cannot be written to, so that they are handed to Python as they
//! are; a command that reads them gets one copy.

use std::path::{Path, PathBuf};

use drivescope::call;
use drivescope_recording::{Recording as Signals, Report};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::raised;

/// Uniformly sampled signals with names and units.
#[pyclass(frozen, module = "drivescope._drivescope")]
pub(crate) struct Recording {
    /// Everything but the values.
    about: Signals,
    columns: Vec<Py<PyArray1<f64>>>,
    /// Of one that was read; one that was simulated is looked at when a command takes it.
    report: Option<Report>,
}

impl Recording {
    /// Of a command's output.
    pub(crate) fn made(py: Python<'_>, mut signals: Signals) -> PyResult<Self> {
        let mut columns = Vec::with_capacity(signals.signals.len());
        for signal in &mut signals.signals {
            let array = PyArray1::from_vec(py, std::mem::take(&mut signal.values));
            array.try_readwrite()?.make_nonwriteable();
            columns.push(array.unbind());
        }
        Ok(Self { about: signals, columns, report: None })
    }

    fn read_as(py: Python<'_>, (signals, report): (Signals, Report)) -> PyResult<Self> {
        Ok(Self { report: Some(report), ..Self::made(py, signals)? })
    }

    /// A copy of the signals.
    fn signals(&self, py: Python<'_>) -> PyResult<Signals> {
        let mut signals = self.about.clone();
        for (signal, column) in signals.signals.iter_mut().zip(&self.columns) {
            signal.values = column.bind(py).try_readonly()?.as_slice()?.to_vec();
        }
        Ok(signals)
    }

    /// What a command gets that reads it under that name.
    pub(crate) fn handed_over(&self, py: Python<'_>, name: &Path) -> PyResult<(Signals, Report)> {
        let signals = self.signals(py)?;
        match &self.report {
            Some(report) => Ok((signals, report.clone())),
            None => {
                let name = name.display().to_string();
                py.detach(|| call::reread(signals, &name)).map_err(raised)
            }
        }
    }

    fn samples(&self, py: Python<'_>) -> PyResult<usize> {
        self.columns.first().map_or(Ok(0), |column| column.bind(py).len())
    }
}

#[pymethods]
impl Recording {
    /// Reads a file of any format.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        columns: Option<&str>,
        resample: Option<f64>,
        rows_every: Option<f64>,
    ) -> PyResult<Self> {
        let read = py.detach(|| call::read(&path, (columns, resample, rows_every)));
        Self::read_as(py, read.map_err(raised)?)
    }

    /// Takes columns as those of a file of that name.
    #[staticmethod]
    fn of_columns(
        py: Python<'_>,
        name: &str,
        signals: Vec<(String, PyReadonlyArray1<'_, f64>)>,
        columns: Option<&str>,
        resample: Option<f64>,
        rows_every: Option<f64>,
    ) -> PyResult<Self> {
        let mut copied = Vec::with_capacity(signals.len());
        for (header, values) in signals {
            copied.push((header, values.as_slice()?.to_vec()));
        }
        let taken = py.detach(|| call::of_columns(name, copied, (columns, resample, rows_every)));
        Self::read_as(py, taken.map_err(raised)?)
    }

    /// What it came from.
    #[getter]
    fn name(&self) -> &str {
        &self.about.name
    }

    /// Time of the first sample, s.
    #[getter]
    fn start(&self) -> f64 {
        self.about.start_s
    }

    /// Sampling time, s.
    #[getter]
    fn period(&self) -> f64 {
        self.about.period_s
    }

    /// Names and units of the signals.
    #[getter]
    fn units(&self) -> Vec<(&str, &str)> {
        self.about.signals.iter().map(|it| (&*it.name, &*it.unit)).collect()
    }

    /// What was assumed in reading, and what deserves attention.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        let of = |report: &Report| [report.guesses(), report.warnings()].concat();
        self.report.as_ref().map_or_else(Vec::new, of)
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.samples(py)
    }

    /// The values of the signal at that place.
    fn values(&self, py: Python<'_>, at: usize) -> Option<Py<PyArray1<f64>>> {
        self.columns.get(at).map(|column| column.clone_ref(py))
    }

    /// When the samples were taken, s.
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (clock, samples) = (self.about.clock(), self.samples(py)?);
        Ok(PyArray1::from_vec(py, (0..samples).map(|k| clock.time(k)).collect()))
    }

    /// First sample of each segment, and the one after its last.
    fn segments(&self, py: Python<'_>) -> PyResult<Vec<(usize, usize)>> {
        let segments = self.about.clock().segments(self.samples(py)?);
        Ok(segments.into_iter().map(|segment| (segment.start, segment.end)).collect())
    }

    /// Writes it; the extension tells the format.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let signals = self.signals(py)?;
        py.detach(|| call::write(&path, &signals)).map_err(raised)
    }

    /// A page of it with spans: from, to, s, and what they say.
    fn page(&self, py: Python<'_>, spans: Vec<(f64, f64, String)>) -> PyResult<String> {
        let signals = self.signals(py)?;
        py.detach(|| call::page(&signals, &spans)).map_err(raised)
    }
}
