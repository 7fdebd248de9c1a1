//! Finds and loads the binary of an FMU for this platform.

use std::fs;
use std::path::{Path, PathBuf};

use libloading::Library;

use super::binding;
use super::description::{Description, Interface, Version};
use super::error::Error;
use super::functions::Functions;
use super::python;

/// A loaded binary. It stays loaded until the FMU and its last instance are dropped: unloading
/// between two instances would run a foreign library's finalisers again and again.
pub(super) struct Binary {
    pub(super) functions: Functions,
    pub(super) library: Library,
}

impl Binary {
    /// Loads the binary for one interface type from the folder of an unpacked FMU.
    pub(super) fn load(
        folder: &Path,
        fmu: &str,
        description: &Description,
        kind: Interface,
    ) -> Result<Binary, Error> {
        let identifier = &description.capabilities(kind).expect("checked").model_identifier;
        let platform = platform(description.fmi);
        let file = format!("{identifier}{}", std::env::consts::DLL_SUFFIX);
        let relative = PathBuf::from("binaries").join(platform).join(file);
        let path = folder.join(&relative);
        if !path.is_file() || identifier.contains(['/', '\\']) {
            return Err(Error::Platform {
                fmu: fmu.to_owned(),
                platform,
                missing: relative.display().to_string(),
                has: platforms(folder),
            });
        }
        let mut needs_python = python::is_provided() && python::is_used_by(&path);
        let library = binding::load(&path, false).or_else(|source| {
            if python::is_missing(&source) {
                python::provide(fmu)?;
                needs_python = true;
                binding::load(&path, false)
                    .map_err(|source| Error::Load { fmu: fmu.to_owned(), source })
            } else {
                Err(Error::Load { fmu: fmu.to_owned(), source })
            }
        })?;
        if needs_python {
            binding::leave_before_finalisers();
        }
        let functions = Functions::load(&library, description.fmi);
        Ok(Binary { functions, library })
    }
}

/// This platform as the standard calls it (FMI 2.0 section 2.3, FMI 3.0 section 2.5.1.4).
pub(super) fn platform(fmi: Version) -> &'static str {
    let windows = cfg!(target_os = "windows");
    let mac = cfg!(target_os = "macos");
    match (fmi, std::env::consts::ARCH) {
        (Version::Two, "x86_64") if windows => "win64",
        (Version::Two, "x86_64") if mac => "darwin64",
        (Version::Two, "x86_64") => "linux64",
        (Version::Two, "x86") if windows => "win32",
        (Version::Two, "x86") => "linux32",
        (Version::Three, "x86_64") if windows => "x86_64-windows",
        (Version::Three, "x86_64") if mac => "x86_64-darwin",
        (Version::Three, "x86_64") => "x86_64-linux",
        (Version::Three, "x86") if windows => "x86-windows",
        (Version::Three, "x86") => "x86-linux",
        // FMI 2.0 names no other processor; exporters took the names of FMI 3.0.
        (_, "aarch64") if windows => "aarch64-windows",
        (_, "aarch64") if mac => "aarch64-darwin",
        (_, "aarch64") => "aarch64-linux",
        _ => "this processor",
    }
}

/// The platforms that an unpacked FMU has binaries for, sorted.
pub(super) fn platforms(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder.join("binaries")).into_iter().flatten().flatten();
    let folders = entries.filter(|entry| entry.path().is_dir());
    let mut names: Vec<_> =
        folders.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
