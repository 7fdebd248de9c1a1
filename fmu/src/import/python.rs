//! FMUs that `pythonfmu` and `pythonfmu3` made for Linux and macOS expect to be loaded by a Python
//! process: their binary uses Python's C functions but names no library that has them. In a host that
//! is not Python, that library has to be loaded first, for all to see.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use super::binding;
use super::error::Error;

/// Whether the linker failed because Python's functions are nowhere.
pub(super) fn is_missing(error: &libloading::Error) -> bool {
    let text = error.to_string();
    // `undefined symbol: PyList_New` on Linux, `symbol not found ... '_PyList_New'` on macOS.
    ["symbol: Py", "symbol: _Py", "'_Py", "'__Py"].iter().any(|mark| text.contains(mark))
}

/// Loads a Python library for the rest of the process. Python cannot be unloaded and loaded again.
pub(super) fn provide(fmu: &str) -> Result<(), Error> {
    static LOADED: Mutex<bool> = Mutex::new(false);
    let mut loaded = LOADED.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if *loaded {
        return Ok(());
    }
    let fail = |reason: String| Error::Python { fmu: fmu.to_owned(), reason };
    let candidates = candidates().map_err(fail)?;
    let mut reason = "it names no shared library".to_owned();
    for path in candidates {
        match binding::load(&path, true) {
            Ok(library) => {
                std::mem::forget(library);
                *loaded = true;
                return Ok(());
            }
            Err(error) => reason = error.to_string(),
        }
    }
    Err(fail(reason))
}

/// Where the library may be: as told, or as the interpreter itself says.
fn candidates() -> Result<Vec<PathBuf>, String> {
    if let Some(path) = std::env::var_os("DRIVESCOPE_LIBPYTHON") {
        return Ok(vec![path.into()]);
    }
    let python = std::env::var_os("DRIVESCOPE_PYTHON").unwrap_or_else(|| "python3".into());
    let name = Path::new(&python).display().to_string();
    const ASK: &str = "import sysconfig as s\n\
        for d in ('LIBDIR', 'LIBPL'):\n\
        \x20for f in ('INSTSONAME', 'LDLIBRARY'):\n\
        \x20 print((s.get_config_var(d) or '') + '/' + (s.get_config_var(f) or ''))\n\
        print(s.get_config_var('INSTSONAME') or '')";
    let output = Command::new(&python).args(["-c", ASK]).output();
    let output = output.map_err(|error| format!("`{name}` cannot be run: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    // A static library (`.a`) is named too where Python was built without a shared one.
    let shared = |line: &&str| line.contains(".so") || line.ends_with(".dylib");
    let found: Vec<PathBuf> = text.lines().filter(shared).map(PathBuf::from).collect();
    if found.is_empty() { Err(format!("`{name}` has no shared library")) } else { Ok(found) }
}
