//! The Python module `drivescope._drivescope`, which the package `drivescope` wraps.
//!
//! It calls the commands of the program (`drivescope::call`) with the arguments of the command line,
//! and hands recordings over and back as numpy's arrays. While a command runs, Python's lock is free;
//! the calling thread looks after Ctrl-C and shows progress. Bad input is `drivescope.Error`, a
//! `ValueError`; an internal error is a `RuntimeError`.

mod call;
mod recording;
mod scenarios;

use std::ffi::OsString;

use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use drivescope::call::Refused;

// Named as users know it, so that it can be sent to other processes.
pyo3::create_exception!(
    drivescope,
    Error,
    PyValueError,
    "Input that cannot be used: what is wrong, where, and the next step."
);

/// The exception for what was refused.
fn raised(refused: Refused) -> PyErr {
    match refused {
        Refused::BadInput(said) => Error::new_err(said),
        Refused::Stopped => PyKeyboardInterrupt::new_err("stopped"),
        Refused::Internal(said) => PyRuntimeError::new_err(said),
    }
}

/// Text of a drive file or of a built-in drive, and the drive's name.
#[pyfunction]
fn drive(py: Python<'_>, given: &str) -> PyResult<(String, String)> {
    py.detach(|| drivescope::call::drive(given)).map_err(raised)
}

/// Checks the text of a drive file; the drive's name.
#[pyfunction]
fn drive_name(py: Python<'_>, text: &str, name: &str) -> PyResult<String> {
    py.detach(|| drivescope::call::drive_name(text, name)).map_err(raised)
}

/// Runs the command line with these arguments, the first of which is its name; the exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| drivescope::call::main(arguments))
}

/// Removes what calls left that never came to their end.
#[pyfunction]
fn leave_nothing() {
    drivescope::call::leave_nothing();
}

/// The module.
#[pymodule]
fn _drivescope(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let python = module.py().import("sys")?.getattr("executable")?.extract::<Option<OsString>>()?;
    let words = ["-m", "drivescope"].map(OsString::from);
    drivescope::call::install(python.into_iter().chain(words).collect());
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<recording::Recording>()?;
    module.add_class::<call::Answer>()?;
    module.add_class::<scenarios::Scenarios>()?;
    module.add_function(wrap_pyfunction!(call::call, module)?)?;
    module.add_function(wrap_pyfunction!(drive, module)?)?;
    module.add_function(wrap_pyfunction!(drive_name, module)?)?;
    module.add_function(wrap_pyfunction!(leave_nothing, module)?)?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(scenarios::part, module)?)?;
    module.add_function(wrap_pyfunction!(scenarios::merged, module)?)?;
    Ok(())
}
