//! A mark in a folder: who works there, so that nobody else does at the same time.

use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::interrupt::Leftover;

/// A mark that is there while this lives.
#[derive(Debug)]
pub(crate) struct Claim {
    file: PathBuf,
    _leftover: Leftover,
}

impl Claim {
    /// Puts a mark of that name into the folder.
    ///
    /// # Errors
    /// Another run has put one there, or the folder cannot be written to.
    pub(crate) fn take(folder: &Path, name: &str) -> Result<Self, Failure> {
        let file = folder.join(name);
        let failed = |source| Failure::Write { path: file.clone(), source };
        // A second try, where the first found the mark of a run that is no more.
        for _ in 0..2 {
            match OpenOptions::new().write(true).create_new(true).open(&file) {
                Ok(mut mark) => {
                    let leftover = Leftover::new(&file);
                    writeln!(mark, "{}{}", std::process::id(), of_host()).map_err(failed)?;
                    return Ok(Self { file, _leftover: leftover });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                    if let Some(by) = Self::holder(&file) {
                        return Err(Failure::Usage {
                            what: format!(
                                "{}: another run writes there (process {by})",
                                folder.display()
                            ),
                            instead: format!(
                                "choose another folder, or remove {} if that run is no more",
                                file.display()
                            ),
                        });
                    }
                    fs::remove_file(&file).map_err(failed)?;
                }
                Err(error) => return Err(failed(error)),
            }
        }
        Err(failed(io::Error::from(ErrorKind::AlreadyExists)))
    }

    /// Who has put a mark there, if that run may still live.
    pub(crate) fn holder(file: &Path) -> Option<String> {
        let by = fs::read_to_string(file).ok()?;
        let by = by.trim();
        let (process, host) = by.split_once(' ').unwrap_or((by, ""));
        // Of another machine nothing is known.
        let here = format!(" {host}") == of_host() || host.is_empty();
        (!here || lives(process)).then(|| by.to_owned())
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // What stays is a mark of a process that is no more.
        let _ = fs::remove_file(&self.file);
    }
}

/// A blank and the name of this machine, where the system tells one: a folder may be shared.
fn of_host() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    if name.trim().is_empty() { String::new() } else { format!(" {}", name.trim()) }
}

/// Whether a process of that number lives; on a system that does not tell, it does.
fn lives(process: &str) -> bool {
    let all = Path::new("/proc");
    process
        .parse::<u32>()
        .is_ok_and(|id| !all.join("self").exists() || all.join(id.to_string()).exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_taken_once_and_left_by_whoever_is_no_more() {
        let here = tempfile::tempdir().expect("a folder");
        let claim = Claim::take(here.path(), ".mark").expect("it is free");
        let refused = Claim::take(here.path(), ".mark").expect_err("it is taken").to_string();
        assert!(refused.contains("another run writes there"), "{refused}");
        drop(Claim::take(here.path(), ".other").expect("another mark"));
        drop(claim);
        assert_eq!(here.path().read_dir().expect("a folder").count(), 0);
        let mark = here.path().join(".mark");
        fs::write(&mark, format!("4294967295{}", of_host())).expect("written");
        assert!(Claim::holder(&mark).is_none());
        drop(Claim::take(here.path(), ".mark").expect("it is free again"));
        fs::write(&mark, "1 elsewhere").expect("written");
        assert!(Claim::take(here.path(), ".mark").is_err(), "of another machine");
    }
}
