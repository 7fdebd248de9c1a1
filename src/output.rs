//! Files and standard output: whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

use drivescope_recording::{Recording, TextSignal, write_whole};
use serde::Serialize;

use crate::failure::{Failure, Stopped, into_report};
use crate::interrupt;

/// Writes a file, whole or not at all; a device or a pipe is written through.
///
/// # Errors
/// [`Failure::Write`] with the path; whatever was there before is untouched.
pub(crate) fn write_file(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), Failure> {
    let _not_now = interrupt::writing();
    unless_stopped()?;
    write_whole(path, content).map_err(|source| Failure::Write { path: path.to_owned(), source })
}

/// Writes a recording; its extension tells the format.
///
/// # Errors
/// The path, where it cannot be written or its format is not known.
pub(crate) fn write_recording(path: &Path, recording: &Recording) -> miette::Result<()> {
    let _not_now = interrupt::writing();
    unless_stopped()?;
    drivescope_recording::write(path, recording).map_err(into_report)
}

/// A run that was stopped writes nothing any more, though it may notice late; but for one that answers
/// with what it has.
fn unless_stopped() -> Result<(), Stopped> {
    if interrupt::may_write() { Ok(()) } else { Err(Stopped) }
}

/// Writes a recording as CSV with columns of text behind it.
///
/// # Errors
/// The path, where it cannot be written or is no `.csv`.
pub(crate) fn write_with_texts(
    path: &Path,
    recording: &Recording,
    texts: &[TextSignal],
) -> miette::Result<()> {
    if texts.is_empty() {
        return write_recording(path, recording);
    }
    if path.extension().is_some_and(|extension| !extension.eq_ignore_ascii_case("csv")) {
        let names: Vec<&str> = texts.iter().map(|signal| signal.name.as_str()).collect();
        return Err(Failure::Usage {
            what: format!("{}: {} can stand in a CSV file only", path.display(), names.join(", ")),
            instead: "name the recording .csv, or choose numbers with --record".to_owned(),
        }
        .into());
    }
    let _not_now = interrupt::writing();
    unless_stopped()?;
    drivescope_recording::write_csv_with_texts(path, recording, texts).map_err(into_report)
}

/// Finds out whether a file can be written there, before the work that fills it.
///
/// # Errors
/// [`Failure::Write`] with the path.
pub(crate) fn check_writable(path: &Path) -> Result<(), Failure> {
    let _not_now = interrupt::writing();
    drivescope_recording::check_writable(path)
        .map_err(|source| Failure::Write { path: path.to_owned(), source })
}

/// The value as JSON text, ending in a line end; numbers that are not finite become `null`.
pub(crate) fn json(value: &impl Serialize) -> Result<String, Failure> {
    let refused = |error: serde_json::Error| Failure::Print { source: error.into() };
    Ok(serde_json::to_string_pretty(value).map_err(refused)? + "\n")
}

/// The same on one line, as a stream of answers has it.
///
/// # Errors
/// A value that JSON does not hold.
pub(crate) fn json_line(value: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|error| Failure::Print { source: error.into() })
}

/// Prints to standard output.
///
/// # Errors
/// [`Failure::Unread`] where the reader has gone away, which is no error of the user's.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(|source| {
        match source.kind() {
            ErrorKind::BrokenPipe => Failure::Unread,
            _ => Failure::Print { source },
        }
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use super::*;

    #[test]
    fn a_file_is_written_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.txt");
        write_file(&path, |out| out.write_all(b"before")).expect("it can be written");
        let failed = write_file(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(failed.expect_err("it failed").to_string().contains("a.txt"));
        assert_eq!(std::fs::read_to_string(&path).expect("it is there"), "before");
        assert_eq!(folder.path().read_dir().expect("a folder").count(), 1);
        assert!(check_writable(folder.path()).is_err());
        assert!(check_writable(&folder.path().join("none/a.txt")).is_err());
    }

    #[test]
    fn a_run_that_was_stopped_writes_nothing_in_any_way() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.csv");
        let text = TextSignal { name: "mode".to_owned(), values: vec!["on".to_owned()] };
        let recording = Recording::new("a", 0.0, 1.0, Vec::new());
        interrupt::listen(&Arc::new(AtomicBool::new(true)));
        let each = [
            write_file(&path, |out| out.write_all(b"late")).map_err(miette::Report::from),
            write_recording(&path, &recording),
            write_with_texts(&path, &recording, &[text]),
        ];
        for written in each {
            let error = written.expect_err("it was stopped");
            assert_eq!(crate::failure::report(&error), crate::failure::Ending::Stopped);
        }
        assert_eq!(folder.path().read_dir().expect("a folder").count(), 0);
    }

    #[test]
    fn json_has_no_number_that_is_none() {
        let text = json(&[1.5, f64::NAN, f64::INFINITY]).expect("it is data");
        assert_eq!(text.split_whitespace().collect::<String>(), "[1.5,null,null]");
    }
}
