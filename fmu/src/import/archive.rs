//! Unpacks an FMU's archive into a private temporary folder. An FMU comes from elsewhere, so nothing
//! in it may reach outside that folder, and it may not fill the disk.

use std::collections::HashSet;
use std::fs;
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};

use zip::ZipArchive;
use zip::result::ZipError;

use super::error::Error;
use super::problem::UnsafeEntry;
use super::unpacked::Unpacked;

/// What an FMU may unpack to. The largest FMUs in use hold a few hundred megabytes of resources.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Bytes of all unpacked files together.
    pub bytes: u64,
    /// Files and folders.
    pub entries: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { bytes: 4 << 30, entries: 100_000 }
    }
}

/// Unpacks the archive at `path` into a new temporary folder, which lives as long as the value.
///
/// # Errors
/// The file cannot be read, is no or a damaged zip archive, holds an entry that would leave the
/// folder, or exceeds the limits. Nothing is left behind then.
pub(crate) fn unpack(path: &Path, fmu: &str, limits: Limits) -> Result<Unpacked, Error> {
    let open = |source| Error::Open { fmu: path.display().to_string(), source };
    let file = fs::File::open(path).map_err(open)?;
    if file.metadata().map_err(open)?.is_dir() {
        return Err(open(io::ErrorKind::IsADirectory.into()));
    }
    let archive = ZipArchive::new(io::BufReader::new(file));
    let archive = archive.map_err(|source| Error::Archive { fmu: fmu.to_owned(), source })?;
    let folder = Unpacked::new().map_err(|source| Error::Unpack {
        fmu: fmu.to_owned(),
        path: std::env::temp_dir(),
        source,
    })?;
    unpack_into(archive, folder.path(), fmu, limits)?;
    Ok(folder)
}

fn unpack_into(
    mut archive: ZipArchive<impl Read + Seek>,
    folder: &Path,
    fmu: &str,
    limits: Limits,
) -> Result<(), Error> {
    let mut remaining = limits.bytes;
    let mut seen = HashSet::new();
    for index in 0..archive.len() {
        let damaged = |entry: String, source| Error::Entry { fmu: fmu.to_owned(), entry, source };
        let mut entry =
            archive.by_index(index).map_err(|source| damaged(format!("#{index}"), source))?;
        let name =
            entry.name().map_err(|source| damaged(format!("#{index}"), source))?.into_owned();
        let refuse = |problem| Error::Unsafe { fmu: fmu.to_owned(), entry: name.clone(), problem };
        let too_large =
            |limit, unit| Error::TooLarge { fmu: fmu.to_owned(), entry: name.clone(), limit, unit };
        if index as u64 >= limits.entries {
            return Err(too_large(limits.entries, "entries"));
        }
        let relative = safe_path(&name).map_err(refuse)?;
        if is_special(entry.unix_mode()) {
            return Err(refuse(UnsafeEntry::Special));
        }
        let target = folder.join(&relative);
        let write = |source| Error::Unpack { fmu: fmu.to_owned(), path: target.clone(), source };
        if entry.is_dir() {
            fs::create_dir_all(&target).map_err(write)?;
            continue;
        }
        if !seen.insert(relative) {
            return Err(refuse(UnsafeEntry::Twice));
        }
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent).map_err(write)?;
        }
        let mut out = fs::File::create(&target).map_err(write)?;
        // The sizes in the archive's directory can lie: what is written is what counts.
        remaining = copy_up_to(remaining, &mut entry, &mut out).map_err(|error| match error {
            Copy::Full => too_large(limits.bytes, "bytes"),
            Copy::Read(source) => damaged(name.clone(), ZipError::Io(source)),
            Copy::Write(source) => write(source),
        })?;
    }
    Ok(())
}

enum Copy {
    Full,
    Read(io::Error),
    Write(io::Error),
}

/// Copies all of `from`, at most `left` bytes; how many bytes are left after it.
fn copy_up_to(
    mut remaining: u64,
    from: &mut impl Read,
    to: &mut impl io::Write,
) -> Result<u64, Copy> {
    let mut buffer = [0; 64 << 10];
    loop {
        match from.read(&mut buffer) {
            Ok(0) => return Ok(remaining),
            Ok(n) => {
                remaining = remaining.checked_sub(n as u64).ok_or(Copy::Full)?;
                to.write_all(&buffer[..n]).map_err(Copy::Write)?;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(Copy::Read(error)),
        }
    }
}

/// The entry's path below the folder. Some tools write `\` for `/`, which is taken as such.
fn safe_path(name: &str) -> Result<PathBuf, UnsafeEntry> {
    let name = name.replace('\\', "/");
    if name.starts_with('/') || name.as_bytes().get(1) == Some(&b':') {
        return Err(UnsafeEntry::Absolute);
    }
    let mut path = PathBuf::new();
    for part in name.split('/').filter(|part| !part.is_empty() && *part != ".") {
        if part == ".." {
            return Err(UnsafeEntry::Escapes);
        }
        // A colon opens an alternate data stream on Windows.
        if part.contains(['\0', ':']) {
            return Err(UnsafeEntry::Name);
        }
        path.push(part);
    }
    if path.as_os_str().is_empty() { Err(UnsafeEntry::Name) } else { Ok(path) }
}

/// Whether the Unix mode says that it is neither a file nor a folder.
fn is_special(mode: Option<u32>) -> bool {
    const KIND: u32 = 0o170_000;
    const FILE: u32 = 0o100_000;
    const FOLDER: u32 = 0o040_000;
    !matches!(mode.map_or(0, |mode| mode & KIND), 0 | FILE | FOLDER)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use zip::write::SimpleFileOptions;

    fn archive(entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut zip = zip::ZipWriter::new(io::Cursor::new(Vec::new()));
        for (name, bytes) in entries {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.finish().unwrap().into_inner()
    }

    fn unpack_bytes(bytes: &[u8], limits: Limits) -> Result<Unpacked, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("test.fmu");
        fs::write(&path, bytes).unwrap();
        unpack(&path, "test.fmu", limits)
    }

    #[test]
    fn files_and_folders_are_unpacked() {
        let bytes = archive(&[("modelDescription.xml", b"x"), ("resources\\a/b.txt", b"hello")]);
        let folder = unpack_bytes(&bytes, Limits::default()).unwrap();
        assert_eq!(fs::read(folder.path().join("resources/a/b.txt")).unwrap(), b"hello");
        let path = folder.path().to_owned();
        drop(folder);
        assert!(!path.exists());
    }

    #[test]
    fn entries_that_lead_outside_are_refused() {
        for (name, problem) in [
            ("../evil", UnsafeEntry::Escapes),
            ("a/../../evil", UnsafeEntry::Escapes),
            ("..\\evil", UnsafeEntry::Escapes),
            ("/etc/evil", UnsafeEntry::Absolute),
            ("C:\\evil", UnsafeEntry::Absolute),
            ("a/b:stream", UnsafeEntry::Name),
        ] {
            let error = unpack_bytes(&archive(&[(name, b"x")]), Limits::default()).unwrap_err();
            let Error::Unsafe { entry, problem: found, .. } = &error else { panic!("{error}") };
            assert_eq!((entry.as_str(), *found), (name, problem));
            assert!(error.to_string().contains("test.fmu"), "{error}");
        }
    }

    #[test]
    fn symbolic_links_are_refused() {
        let mut zip = zip::ZipWriter::new(io::Cursor::new(Vec::new()));
        zip.add_symlink("resources/x", "/etc/passwd", SimpleFileOptions::default()).unwrap();
        let bytes = zip.finish().unwrap().into_inner();
        let error = unpack_bytes(&bytes, Limits::default()).unwrap_err();
        assert!(matches!(error, Error::Unsafe { problem: UnsafeEntry::Special, .. }), "{error}");
    }

    #[test]
    fn size_and_number_of_entries_are_limited() {
        let bytes = archive(&[("a", &[0; 100_000]), ("b", b"x")]);
        let error = unpack_bytes(&bytes, Limits { bytes: 99_999, entries: 9 }).unwrap_err();
        assert!(matches!(error, Error::TooLarge { unit: "bytes", .. }), "{error}");
        let error = unpack_bytes(&bytes, Limits { bytes: 1 << 20, entries: 1 }).unwrap_err();
        assert!(matches!(error, Error::TooLarge { unit: "entries", .. }), "{error}");
        assert!(unpack_bytes(&bytes, Limits { bytes: 100_001, entries: 2 }).is_ok());
    }

    #[test]
    fn damage_is_found_and_named() {
        let text: Vec<u8> = (0..20_000_u32).flat_map(|k| (k * k).to_le_bytes()).collect();
        let mut bytes = archive(&[("modelDescription.xml", &text)]);
        for byte in &mut bytes[2000..2050] {
            *byte ^= 0x55;
        }
        let error = unpack_bytes(&bytes, Limits::default()).unwrap_err();
        assert!(matches!(&error, Error::Entry { entry, .. } if entry == "modelDescription.xml"));
        let error = unpack_bytes(&bytes[..500], Limits::default()).unwrap_err();
        assert!(matches!(error, Error::Archive { .. }), "{error}");
        let error = unpack(Path::new("/nonexistent.fmu"), "x", Limits::default()).unwrap_err();
        assert!(error.to_string().contains("/nonexistent.fmu"), "{error}");
    }
}
