//! The forms that a system description may have, by the names of their files.

use std::path::Path;

use super::document::Document;
use super::error::Error;
use super::{ssp, text_form};

/// Reads a system description: `.toml`, `.ssd` or `.ssp`.
///
/// # Errors
/// A file that cannot be read or has another name; what is wrong in it, with line and column.
pub fn open(path: impl AsRef<Path>) -> Result<Document, Error> {
    let path = path.as_ref();
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("toml") => text_form::read(path),
        Some("ssd") => ssp::read(path),
        Some("ssp") => ssp::read_package(path),
        _ => Err(Error::FileKind { path: path.to_owned() }),
    }
}
