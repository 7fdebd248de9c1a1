//! The folder of a run that writes many files: nobody else writes there meanwhile, and nothing appears
//! in it before all is done.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use drivescope_recording::write_whole;
use tempfile::TempDir;

use crate::claim::Claim;
use crate::failure::Failure;
use crate::interrupt::{self, Leftover};

/// File that says who writes there.
const TAKEN: &str = ".drivescope-running";

/// A folder that this run alone writes to.
#[derive(Debug)]
pub(crate) struct RunFolder {
    path: PathBuf,
    /// Folders that were made for it, the outermost first.
    made: Vec<(PathBuf, Leftover)>,
    taken: Option<Claim>,
    work: Option<(TempDir, Leftover)>,
}

impl RunFolder {
    /// Takes the folder, made if it is not there.
    ///
    /// # Errors
    /// It cannot be written to, or another run writes there.
    pub(crate) fn take(path: &Path) -> Result<Self, Failure> {
        let failed = |source| Failure::Write { path: path.to_owned(), source };
        let mut folder = Self { path: path.to_owned(), made: Vec::new(), taken: None, work: None };
        folder.make(path).map_err(failed)?;
        folder.taken = Some(Claim::take(path, TAKEN)?);
        let work = tempfile::Builder::new().prefix(interrupt::OWN).tempdir_in(path);
        let work = work.map_err(failed)?;
        let leftover = Leftover::new(work.path());
        folder.work = Some((work, leftover));
        Ok(folder)
    }

    fn make(&mut self, path: &Path) -> io::Result<()> {
        if path.as_os_str().is_empty() || path.is_dir() {
            return Ok(());
        }
        self.make(path.parent().unwrap_or(Path::new("")))?;
        match fs::create_dir(path) {
            Ok(()) => self.made.push((path.to_owned(), Leftover::new(path))),
            Err(error) if error.kind() == ErrorKind::AlreadyExists && path.is_dir() => {}
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// The folder in which the run puts its files until it is done.
    pub(crate) fn work(&self) -> &Path {
        self.work.as_ref().map_or(&self.path, |(work, _)| work.path())
    }

    /// Puts all that the run has made in place; what was there before is replaced file by file.
    ///
    /// # Errors
    /// The file that cannot be put there.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        let _not_now = interrupt::writing();
        if let Some((work, _)) = &self.work {
            put_in_place(work.path(), &self.path)
                .map_err(|source| Failure::Write { path: self.path.clone(), source })?;
        }
        self.made.clear();
        Ok(())
    }
}

fn put_in_place(from: &Path, to: &Path) -> io::Result<()> {
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            fs::create_dir_all(&target)?;
            put_in_place(&entry.path(), &target)?;
        } else if target.symlink_metadata().is_ok_and(|there| !there.is_file()) {
            // Where the user put a link or a device, it stays.
            let mut made = fs::File::open(entry.path())?;
            write_whole(&target, |out| io::copy(&mut made, out).map(drop))?;
        } else {
            fs::rename(entry.path(), target)?;
        }
    }
    Ok(())
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        self.work = None;
        self.taken = None;
        for (path, _) in self.made.drain(..).rev() {
            // Only if it is still empty.
            let _ = fs::remove_dir(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_taken_once_and_filled_at_the_end() {
        let here = tempfile::tempdir().expect("a folder");
        let path = here.path().join("deep/study");
        let run = RunFolder::take(&path).expect("it is free");
        let refused = RunFolder::take(&path).expect_err("it is taken").to_string();
        assert!(refused.contains("another run writes there"), "{refused}");
        fs::create_dir(run.work().join("runs")).expect("a folder");
        fs::write(run.work().join("runs/a.csv"), "1").expect("written");
        assert!(!path.join("runs").exists(), "not before the end");
        run.finish().expect("it is put in place");
        assert_eq!(fs::read_to_string(path.join("runs/a.csv")).expect("it is there"), "1");
        assert_eq!(path.read_dir().expect("a folder").count(), 1, "nothing else");
        #[cfg(unix)]
        {
            // What the user linked elsewhere is written there, and the link stays.
            std::os::unix::fs::symlink("../there.csv", path.join("b.csv")).expect("a link");
            let run = RunFolder::take(&path).expect("it is free");
            fs::write(run.work().join("b.csv"), "2").expect("written");
            run.finish().expect("it is put in place");
            assert!(path.join("b.csv").is_symlink());
            let there = fs::read_to_string(here.path().join("deep/there.csv"));
            assert_eq!(there.expect("it is there"), "2");
            fs::remove_file(path.join("b.csv")).expect("it is there");
        }
        // The mark of a process that is no more is no obstacle.
        fs::write(path.join(TAKEN), "4294967295").expect("written");
        drop(RunFolder::take(&path).expect("it is free again"));
        assert_eq!(path.read_dir().expect("a folder").count(), 1);
    }

    #[test]
    fn a_run_that_comes_to_nothing_leaves_nothing() {
        let here = tempfile::tempdir().expect("a folder");
        let run = RunFolder::take(&here.path().join("a/b")).expect("it is free");
        fs::write(run.work().join("half.csv"), "1").expect("written");
        drop(run);
        assert_eq!(here.path().read_dir().expect("a folder").count(), 0);
    }
}
