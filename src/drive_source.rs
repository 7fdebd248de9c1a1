//! Where a drive comes from: a drive file, or the name of a built-in drive.

use std::io::Read;
use std::path::Path;

use drivescope_plant::drive::Drive;
use drivescope_plant::file::DriveFileError;
use drivescope_scenarios::drives::BUILT_IN;
use miette::{Diagnostic, NamedSource, SourceSpan};
use thiserror::Error;

use crate::failure::{Failure, visible};

/// A drive file that is wrong, with the text around the place.
#[derive(Debug, Error, Diagnostic)]
#[error("{error}")]
struct WrongDriveFile {
    error: DriveFileError,
    #[source_code]
    text: NamedSource<String>,
    #[label("here")]
    span: Option<SourceSpan>,
}

/// The drive of a file or of a built-in name; a file wins over a name.
///
/// # Errors
/// No such file or name, a file that cannot be read, or wrong content, with its place.
pub(crate) fn drive(given: &str) -> miette::Result<Drive> {
    parse(&text(given)?, given)
}

/// The text of its drive file.
///
/// # Errors
/// No such file or name, or a file that cannot be read.
pub(crate) fn text(given: &str) -> miette::Result<String> {
    let path = Path::new(given);
    if !path.exists()
        && let Some((_, text)) = BUILT_IN.iter().find(|(name, _)| *name == given)
    {
        return Ok((*text).to_owned());
    }
    if !path.exists() && !looks_like_a_file(path) {
        let known = BUILT_IN.map(|(name, _)| name).join(", ");
        return Err(Failure::UnknownDrive { name: given.to_owned(), known }.into());
    }
    Ok(read(path).map_err(|source| Failure::Read { path: path.to_owned(), source })?)
}

/// A text that is no longer than any drive file: what is longer is something else.
fn read(path: &Path) -> std::io::Result<String> {
    const LONGEST: u64 = 10_000_000;
    let mut text = String::new();
    let length = std::fs::File::open(path)?.take(LONGEST + 1).read_to_string(&mut text)?;
    if length as u64 > LONGEST {
        let said = format!("it is longer than {LONGEST} bytes, so that it is no drive file");
        return Err(std::io::Error::other(said));
    }
    Ok(text)
}

fn looks_like_a_file(path: &Path) -> bool {
    path.extension().is_some() || path.components().count() > 1
}

/// The drive of that text; `name` is what messages call it.
///
/// # Errors
/// Wrong content, with its place.
pub(crate) fn parse(text: &str, name: &str) -> miette::Result<Drive> {
    Drive::parse(text, name).map_err(|error| {
        let span = error.place().and_then(|place| visible(text, place.span.clone()));
        let text = NamedSource::new(name, text.to_owned()).with_language("toml");
        WrongDriveFile { error, text, span }.into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_drives_are_right() {
        for (name, _) in BUILT_IN {
            drive(name).unwrap_or_else(|error| panic!("{name}: {error:?}"));
        }
    }

    #[test]
    fn what_is_no_drive_is_said() {
        let error = drive("dr3000").expect_err("there is none").to_string();
        assert!(error.contains("`dr3000`"), "{error}");
        let error = drive("no/such.toml").expect_err("there is none").to_string();
        assert!(error.starts_with("no/such.toml: cannot be read"), "{error}");
    }
}
