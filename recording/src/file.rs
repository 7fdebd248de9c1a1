//! Files: read in whatever format they are, written by their extension.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufWriter};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::csv;
use crate::error::Error;
use crate::formats::{Format, by_extension, recognise, written};
use crate::mapping::ReadOptions;
use crate::preview::Preview;
use crate::replace::{is_no_file, write_whole};
use crate::report::Report;
use crate::signal::{Recording, TextSignal};
use crate::table::Table;

thread_local! {
    static READS: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread is reading a file's bytes at the moment. A panic then is a damaged file
/// that a foreign reader stumbles over: [`read()`] returns it as an error, so a panic hook need
/// say nothing.
pub fn is_reading() -> bool {
    READS.get()
}

/// Reads a recording in any of the [formats](crate::formats()): its first bytes tell which, then
/// its extension.
///
/// # Errors
/// Any of [`Error`]; the file and, where there is one, the line are named.
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<(Recording, Report), Error> {
    let path = path.as_ref();
    let file = path.display().to_string();
    opened_table(path, &file, options)?.into_recording(options)
}

/// What reading came to.
pub type Outcome = Result<(Recording, Report), Error>;

/// Reads a recording as [`read()`] does, and looks at its columns whether or not they make one.
///
/// # Errors
/// The file holds no columns of numbers; what their names, units and time lack is within the
/// result.
pub fn read_with_preview(
    path: impl AsRef<Path>,
    options: &ReadOptions,
) -> Result<(Preview, Outcome), Error> {
    let path = path.as_ref();
    let table = opened_table(path, &path.display().to_string(), options)?;
    Ok((Preview::of(&table), table.into_recording(options)))
}

fn opened_table(path: &Path, file: &str, options: &ReadOptions) -> Result<Table, Error> {
    let mut opened = open(path, file)?;
    let format = recognise(&mut opened, path, file)?;
    table(format, opened, file, options)
}

/// The file's columns. Readers of packed formats assert what a damaged file can break (about one
/// in a thousand files with changed bytes), so that a panic is taken for damage here, once.
fn table(format: &Format, opened: File, file: &str, options: &ReadOptions) -> Result<Table, Error> {
    READS.set(true);
    let table = catch_unwind(AssertUnwindSafe(|| (format.read)(opened, file, options)));
    READS.set(false);
    table.unwrap_or_else(|_| {
        let what = "its parts contradict each other".to_owned();
        Err(Error::Damaged { file: file.to_owned(), format: format.name, what })
    })
}

/// Writes a recording; the extension tells the format. Nothing is left half-written: the file
/// gets its name when it is complete. A device or a pipe with another name takes CSV.
///
/// # Errors
/// [`Error::Write`], [`Error::WriteFormat`] or [`Error::UnequalLengths`].
pub fn write(path: impl AsRef<Path>, recording: &Recording) -> Result<(), Error> {
    let path = path.as_ref();
    match by_extension(path).and_then(|format| format.write) {
        Some(content) => put_in_place(path, recording, |out| content(out, recording)),
        None if is_no_file(path) => write_csv(path, recording),
        None => Err(Error::WriteFormat { file: path.display().to_string(), known: written() }),
    }
}

/// Writes a recording as CSV: `time [s],name [unit],...`, numbers that read back to the same bits.
///
/// # Errors
/// As [`write()`].
pub fn write_csv(path: impl AsRef<Path>, recording: &Recording) -> Result<(), Error> {
    put_in_place(path.as_ref(), recording, |out| csv::write(out, recording))
}

/// The same with columns of text behind the signals, one text a sample each; a reader that knows
/// numbers alone passes them over.
///
/// # Errors
/// As [`write()`].
pub fn write_csv_with_texts(
    path: impl AsRef<Path>,
    recording: &Recording,
    texts: &[TextSignal],
) -> Result<(), Error> {
    let length = texts.first().map_or(recording.len(), |signal| signal.values.len());
    let signals = recording.signals.iter().map(|signal| (&signal.name, signal.values.len()));
    let texts_too = texts.iter().map(|signal| (&signal.name, signal.values.len()));
    if let Some((signal, found)) = signals.chain(texts_too).find(|(_, found)| *found != length) {
        let (name, signal) = (recording.name.clone(), signal.clone());
        return Err(Error::UnequalLengths { name, signal, found, expected: length });
    }
    put_in_place(path.as_ref(), recording, |out| csv::write_with_texts(out, recording, texts))
}

/// Puts the file in place whole.
fn put_in_place(
    path: &Path,
    recording: &Recording,
    content: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), Error> {
    recording.check()?;
    write_whole(path, content)
        .map_err(|source| Error::Write { file: path.display().to_string(), source })
}

fn open(path: &Path, file: &str) -> Result<File, Error> {
    let failed = |source| Error::Read { file: file.to_owned(), source };
    let opened = File::open(path).map_err(failed)?;
    let about = opened.metadata().map_err(failed)?;
    if about.is_dir() {
        return Err(Error::IsFolder { file: file.to_owned() });
    }
    Ok(opened)
}
