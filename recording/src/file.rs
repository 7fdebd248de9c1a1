//! Files by their extension.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::csv;
use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::report::Report;
use crate::signal::Recording;
use crate::{mat, parquet};

/// Reads a recording; the extension tells the format.
///
/// # Errors
/// Any of [`Error`]; the file and, where there is one, the line are named.
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<(Recording, Report), Error> {
    let path = path.as_ref();
    let file = path.display().to_string();
    let (opened, bytes) = open(path, &file)?;
    match extension(path).as_str() {
        "csv" | "txt" | "tsv" => csv::read_sized(opened, &file, bytes, options),
        "parquet" | "pq" => parquet::read(opened, &file, options),
        "mat" => mat::read(opened, &file, options),
        extension => Err(Error::Format { file, extension: extension.to_owned() }),
    }
}

/// Writes a recording; the extension tells the format. Nothing is left half-written: the file
/// gets its name when it is complete.
///
/// # Errors
/// [`Error::Write`], [`Error::WriteFormat`] or [`Error::UnequalLengths`].
pub fn write(path: impl AsRef<Path>, recording: &Recording) -> Result<(), Error> {
    let path = path.as_ref();
    match extension(path).as_str() {
        "csv" => write_csv(path, recording),
        "parquet" | "pq" => write_whole(path, recording, |out| parquet::write(out, recording)),
        extension => {
            let (file, extension) = (path.display().to_string(), extension.to_owned());
            Err(Error::WriteFormat { file, extension })
        }
    }
}

/// Writes a recording as CSV: `time [s],name [unit],...`, numbers that read back to the same bits.
///
/// # Errors
/// As [`write()`].
pub fn write_csv(path: impl AsRef<Path>, recording: &Recording) -> Result<(), Error> {
    write_whole(path.as_ref(), recording, |out| csv::write(out, recording))
}

/// Writes to a temporary name in the same folder and renames at the end.
fn write_whole(
    path: &Path,
    recording: &Recording,
    content: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), Error> {
    recording.check()?;
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let written = || -> io::Result<()> {
        if path.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".recording-").suffix(".tmp");
        // Readable as any new file is, not by the owner alone as a temporary one.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let temporary = builder.tempfile_in(folder)?;
        let mut out = BufWriter::new(temporary.as_file());
        content(&mut out)?;
        out.flush()?;
        drop(out);
        temporary.persist(path)?;
        Ok(())
    };
    written().map_err(|source| Error::Write { file: path.display().to_string(), source })
}

/// The file and its size; a pipe has none.
fn open(path: &Path, file: &str) -> Result<(File, Option<u64>), Error> {
    let failed = |source| Error::Read { file: file.to_owned(), source };
    let opened = File::open(path).map_err(failed)?;
    let about = opened.metadata().map_err(failed)?;
    if about.is_dir() {
        return Err(Error::IsFolder { file: file.to_owned() });
    }
    Ok((opened, about.is_file().then_some(about.len())))
}

fn extension(path: &Path) -> String {
    path.extension().map(|text| text.to_string_lossy().to_lowercase()).unwrap_or_default()
}
