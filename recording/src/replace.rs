//! Files that appear whole or not at all.
//!
//! An ordinary file is written under a temporary name beside it and renamed. A symbolic link stays a
//! link: the file that it leads to is written so. What is no file, as a device or a named pipe, is
//! written through: it must never be replaced by one.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Links followed to where a file is to be, as many as the system follows.
const MOST_LINKS: usize = 40;

/// Writes what `content` gives.
///
/// # Errors
/// What the file system refuses, or `content` itself; a file that was there before is untouched.
pub fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> io::Result<()> {
    match target(path)? {
        Target::Through => {
            // Neither made nor cut: what is there takes the bytes.
            let through = OpenOptions::new().write(true).open(path)?;
            let mut out = BufWriter::new(&through);
            content(&mut out)?;
            out.flush()
        }
        Target::File(path) => {
            let temporary = beside(&path)?;
            let mut out = BufWriter::new(temporary.as_file());
            content(&mut out)?;
            out.flush()?;
            drop(out);
            if let Ok(before) = fs::metadata(&path) {
                // Who could read it before can read it now. A system without permissions has none.
                let _ = temporary.as_file().set_permissions(before.permissions());
            }
            temporary.as_file().sync_all()?;
            temporary.persist(&path)?;
            Ok(())
        }
    }
}

/// Finds out whether a file can be written there, before the work that fills it.
///
/// # Errors
/// What the file system refuses.
pub fn check_writable(path: &Path) -> io::Result<()> {
    match target(path)? {
        // To open a named pipe would wait for its reader.
        Target::Through => Ok(()),
        Target::File(path) => beside(&path).map(drop),
    }
}

enum Target {
    /// A file, there or to be, that no link stands for.
    File(PathBuf),
    /// Something that takes bytes and is no file.
    Through,
}

/// Whether a device or a pipe is there, which takes bytes under any name.
pub(crate) fn is_no_file(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

fn target(path: &Path) -> io::Result<Target> {
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(_) if is_no_file(path) => Ok(Target::Through),
        _ => followed(path).map(Target::File),
    }
}

/// The path at the end of a chain of links, whether or not there is a file yet.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            Ok(to) => path = path.parent().unwrap_or(Path::new("")).join(to),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("its symbolic links lead round in a circle"))
}

fn beside(path: &Path) -> io::Result<NamedTempFile> {
    if path.file_name().is_none() {
        return Err(ErrorKind::InvalidInput.into());
    }
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".drivescope-").suffix(".tmp");
    // Readable as any new file is, not by the owner alone as a temporary one.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // The folder is meant, not the temporary name that the error carries.
    builder.tempfile_in(folder.unwrap_or(Path::new("."))).map_err(|error| match error.kind() {
        ErrorKind::NotFound => io::Error::new(error.kind(), "its folder does not exist"),
        kind => kind.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(path: &Path, text: &str) -> io::Result<()> {
        check_writable(path)?;
        write_whole(path, |out| out.write_all(text.as_bytes()))
    }

    #[test]
    fn a_file_is_written_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        put(&path, "before").unwrap();
        let failed = write_whole(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        assert_eq!(folder.path().read_dir().unwrap().count(), 1);
        assert!(check_writable(folder.path()).is_err());
        let absent = check_writable(&folder.path().join("none/a.txt")).unwrap_err();
        assert!(absent.to_string().contains("its folder does not exist"));
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_links_and_lead_to_the_written_file() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("deep")).unwrap();
        fs::write(at("deep/file"), "old").unwrap();
        fs::set_permissions(at("deep/file"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink("deep/file", at("link")).unwrap();
        symlink("link", at("second")).unwrap();
        symlink("deep/to_be", at("dangling")).unwrap();
        for (link, file) in [("second", "deep/file"), ("dangling", "deep/to_be")] {
            put(&at(link), "new").unwrap();
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
            assert_eq!(fs::read_to_string(at(file)).unwrap(), "new", "{link}");
        }
        let mode = fs::metadata(at("deep/file")).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640, "who could read it can read it");
        symlink("round", at("round")).unwrap();
        assert!(put(&at("round"), "new").is_err());
    }

    /// As root a device of the system would be replaced.
    #[cfg(unix)]
    #[test]
    fn devices_and_pipes_are_written_through() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("null");
        symlink("/dev/null", &link).unwrap();
        put(&link, "gone").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());

        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.is_ok_and(|status| status.success()), "mkfifo is part of every Unix");
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read_to_string(pipe).unwrap()
        });
        put(&pipe, "through").unwrap();
        assert_eq!(reader.join().unwrap(), "through");
        assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
        assert_eq!(folder.path().read_dir().unwrap().count(), 2, "nothing beside");
    }
}
