//! FMUs that `pythonfmu` and `pythonfmu3` made for Linux and macOS expect to be loaded by a Python
//! process: their binary uses Python's C functions but names no library that has them. In a host that
//! is not Python, that library has to be loaded first, for all to see.
//!
//! Python is also started here: a binary that starts it itself ends it with its last instance, under
//! the feet of the instances of other FMUs. And their binaries cannot be unloaded (they hold symbols
//! that the linker keeps unique), and when the process ends they free their own state twice: so the
//! process has to end before their finalisers run.

use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use super::binding;
use super::error::{Error, loader_says};

/// Whether the linker failed because Python's functions are nowhere.
pub(super) fn is_missing(error: &libloading::Error) -> bool {
    let text = loader_says(error);
    // `undefined symbol: PyList_New` on Linux, `symbol not found ... '_PyList_New'` on macOS.
    ["symbol: Py", "symbol: _Py", "'_Py", "'__Py"].iter().any(|mark| text.contains(mark))
}

/// Whether Python is loaded.
static PROVIDED: Mutex<bool> = Mutex::new(false);

pub(super) fn is_provided() -> bool {
    *PROVIDED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether a binary calls Python. Once Python is there, the linker no longer says so.
pub(super) fn is_used_by(path: &Path) -> bool {
    const SIGN: &[u8] = b"PyGILState_Ensure";
    std::fs::read(path).is_ok_and(|bytes| bytes.windows(SIGN.len()).any(|part| part == SIGN))
}

/// Loads a Python library for the rest of the process. Python cannot be unloaded and loaded again.
pub(super) fn provide(fmu: &str) -> Result<(), Error> {
    let mut loaded = PROVIDED.lock().unwrap_or_else(PoisonError::into_inner);
    if *loaded {
        return Ok(());
    }
    let fail = |reason: String| Error::Python { fmu: fmu.to_owned(), reason };
    let Python { executable, libraries } = Python::find().map_err(fail)?;
    let mut reason = String::new();
    for path in libraries {
        match binding::load(&path, true) {
            Ok(library) => {
                binding::start_python(&library, executable.as_deref());
                // Whatever has run in Python may hold on to it for good.
                std::mem::forget(library);
                *loaded = true;
                return Ok(());
            }
            Err(error) => reason = loader_says(&error),
        }
    }
    Err(fail(reason))
}

/// A Python installation.
struct Python {
    /// The interpreter, by which Python finds its packages, also those of a virtual environment.
    executable: Option<CString>,
    /// Where its shared library may be.
    libraries: Vec<PathBuf>,
}

impl Python {
    /// As told by the environment, or as the interpreter itself says.
    fn find() -> Result<Python, String> {
        if let Some(path) = std::env::var_os("DRIVESCOPE_LIBPYTHON") {
            return Ok(Python { executable: None, libraries: vec![path.into()] });
        }
        let python = std::env::var_os("DRIVESCOPE_PYTHON").unwrap_or_else(|| "python3".into());
        let name = Path::new(&python).display().to_string();
        const ASK: &str = "import sys, sysconfig as s\n\
            print(sys.executable)\n\
            for d in ('LIBDIR', 'LIBPL'):\n\
            \x20for f in ('INSTSONAME', 'LDLIBRARY'):\n\
            \x20 print((s.get_config_var(d) or '') + '/' + (s.get_config_var(f) or ''))\n\
            print(s.get_config_var('INSTSONAME') or '')";
        let output = Command::new(&python).args(["-c", ASK]).output();
        let output = output.map_err(|error| format!("`{name}` cannot be run: {error}"))?;
        let text = String::from_utf8_lossy(&output.stdout);
        let mut lines = text.lines();
        let executable = lines.next().and_then(|line| CString::new(line).ok());
        // A static library (`.a`) is named too where Python was built without a shared one.
        let shared = |line: &&str| line.contains(".so") || line.ends_with(".dylib");
        let libraries: Vec<PathBuf> = lines.filter(shared).map(PathBuf::from).collect();
        if libraries.is_empty() {
            return Err(format!("`{name}` has no shared library"));
        }
        Ok(Python { executable, libraries })
    }
}
