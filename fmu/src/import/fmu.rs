//! An FMU file: opened, unpacked and described.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::archive::{self, Limits};
use super::binary::{self, Binary};
use super::description::{Description, Interface, Version};
use super::error::Error;
use super::parse;
use super::unpacked::Unpacked;

/// An opened FMU. Cheap to clone; the unpacked files live as long as the last clone and instance.
#[derive(Clone)]
pub struct Fmu {
    pub(super) inner: Arc<Inner>,
}

pub(super) struct Inner {
    pub(super) name: String,
    pub(super) description: Description,
    /// The binaries loaded so far: both interface types may share one.
    binaries: Mutex<Vec<(String, Arc<Binary>)>>,
    /// Set while the one allowed instance lives, if only one is allowed.
    taken: AtomicBool,
    // Dropped after the binaries: Windows does not delete a loaded library.
    folder: Unpacked,
}

impl Fmu {
    /// Opens an FMU: unpacks it into a private temporary folder and reads its description. The binary
    /// is loaded when it is first needed, so an FMU of another platform can be described here.
    ///
    /// # Errors
    /// No readable archive, an unsafe entry, a missing or malformed description, FMI 1.0.
    pub fn open(path: impl AsRef<Path>) -> Result<Fmu, Error> {
        Fmu::open_within(path, Limits::default())
    }

    /// As [`open`](Fmu::open), with limits of one's own to what is unpacked.
    ///
    /// # Errors
    /// As [`open`](Fmu::open).
    pub fn open_within(path: impl AsRef<Path>, limits: Limits) -> Result<Fmu, Error> {
        let path = path.as_ref();
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let folder = archive::unpack(path, &name, limits)?;
        let file = folder.path().join("modelDescription.xml");
        if !file.is_file() {
            return Err(Error::NoDescription { fmu: name });
        }
        let text = fs::read(&file).map_err(|source| Error::Unpack {
            fmu: name.clone(),
            path: file,
            source,
        })?;
        let description = parse::read(&String::from_utf8_lossy(&text), &name)?;
        let inner = Inner {
            name,
            description,
            binaries: Mutex::default(),
            taken: AtomicBool::new(false),
            folder,
        };
        Ok(Fmu { inner: Arc::new(inner) })
    }

    /// The FMU's file name.
    pub fn name(&self) -> &str {
        &self.inner.name
    }

    /// What the FMU says about itself.
    pub fn description(&self) -> &Description {
        &self.inner.description
    }

    /// The platforms that the FMU has binaries for, in the standard's names.
    pub fn platforms(&self) -> Vec<String> {
        binary::platforms(self.inner.folder.path())
    }

    /// The folder with the FMU's resources, if it has any.
    pub fn resources(&self) -> Option<PathBuf> {
        Some(self.inner.folder.path().join("resources")).filter(|path| path.is_dir())
    }

    /// The functions that the standard demands of the binary and that it lacks.
    ///
    /// # Errors
    /// The binary cannot be loaded.
    pub fn missing_functions(&self, kind: Interface) -> Result<Vec<String>, Error> {
        let binary = self.binary(kind)?;
        let identifier = |kind| Some(&self.description().capabilities(kind)?.model_identifier);
        let mut kinds = self.description().interfaces();
        kinds.retain(|other| identifier(*other) == identifier(kind));
        Ok(binary.functions.missing(&binary.library, &kinds))
    }

    pub(super) fn binary(&self, kind: Interface) -> Result<Arc<Binary>, Error> {
        let inner = &*self.inner;
        let Some(capabilities) = inner.description.capabilities(kind) else {
            let has = inner.description.interfaces().iter().map(Interface::to_string).collect();
            return Err(Error::NoInterface { fmu: inner.name.clone(), wanted: kind, has });
        };
        let mut binaries = inner.binaries.lock().unwrap_or_else(PoisonError::into_inner);
        let identifier = &capabilities.model_identifier;
        if let Some((_, binary)) = binaries.iter().find(|(loaded, _)| loaded == identifier) {
            return Ok(Arc::clone(binary));
        }
        let binary = Binary::load(inner.folder.path(), &inner.name, &inner.description, kind)
            .map(Arc::new)?;
        binaries.push((identifier.clone(), Arc::clone(&binary)));
        Ok(binary)
    }

    pub(super) fn take(&self, kind: Interface) -> Result<Option<Once>, Error> {
        if !self.description().capabilities(kind).is_some_and(|c| c.only_once_per_process) {
            return Ok(None);
        }
        if self.inner.taken.swap(true, Ordering::AcqRel) {
            return Err(Error::OnlyOnce { fmu: self.inner.name.clone() });
        }
        Ok(Some(Once(self.clone())))
    }

    /// FMI 2.0 wants a file URI, FMI 3.0 a path that ends with a separator.
    pub(super) fn resource_location(&self) -> Option<String> {
        let path = self.resources()?;
        Some(match self.description().fmi {
            Version::Two => file_uri(&path.to_string_lossy()),
            Version::Three => path.join("").to_string_lossy().into_owned(),
        })
    }
}

impl std::fmt::Debug for Fmu {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        out.debug_struct("Fmu").field("name", &self.inner.name).finish_non_exhaustive()
    }
}

/// Held by the one instance of an FMU that allows no second one.
pub(super) struct Once(Fmu);

impl Drop for Once {
    fn drop(&mut self) {
        self.0.inner.taken.store(false, Ordering::Release);
    }
}

/// The URI of an absolute path, RFC 8089: `file:///tmp/a%20b`.
fn file_uri(path: &str) -> String {
    let path = path.replace('\\', "/");
    let mut uri = String::from(if path.starts_with('/') { "file://" } else { "file:///" });
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'.' | b'_' | b'~' | b':' => {
                uri.push(char::from(byte));
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_uris() {
        assert_eq!(file_uri("/tmp/a b/ü"), "file:///tmp/a%20b/%C3%BC");
        assert_eq!(file_uri("C:\\x"), "file:///C:/x");
    }
}
