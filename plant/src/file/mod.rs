//! The drive file: TOML in SI units, checked as a whole, every error with its place.
//!
//! `document` parses the text and keeps the places; `deserialize` reads it into the tables of
//! `layout`; `check` and `effects`, which takes a table by its `reader`, apply the rules between
//! keys, the registry and the list of [`crate::parameters`], and put a [`Drive`] together. `write`
//! goes the other way, `edit` changes values in a file and keeps its comments, and `schema`
//! describes the file to editors.

mod check;
mod curve;
mod custom;
mod deserialize;
mod document;
mod edit;
mod effects;
mod error;
mod law_text;
mod layout;
mod reader;
mod schema;
#[cfg(test)]
mod tests;
mod write;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::drive::Drive;

pub use curve::{BALANCES, LEARNED};
pub use custom::{CUSTOM, target_key};
pub use edit::Change;
pub use error::{DriveFileError, Location, Problem};
pub use schema::{schema_json, without_null};

impl Drive {
    /// Reads the text of a drive file; `file_name` is only for the error.
    ///
    /// # Errors
    /// [`DriveFileError::Content`] with line, column and what to do about the first thing that
    /// is wrong.
    pub fn parse(text: &str, file_name: &str) -> Result<Self, DriveFileError> {
        document::Document::parse(text)
            .and_then(|document| {
                check::names(&document)?;
                let layout = deserialize::deserialize(&document)?;
                check::drive(&document, layout)
            })
            .map_err(|flaw| flaw.within(file_name, text))
    }

    /// Reads a drive file.
    ///
    /// # Errors
    /// [`DriveFileError`] if it cannot be read or its content is wrong.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DriveFileError> {
        let file = path.as_ref().display().to_string();
        match fs::read_to_string(path) {
            Ok(text) => Self::parse(&text, &file),
            Err(source) => Err(DriveFileError::Read { file, source }),
        }
    }

    /// The text of the drive file: [`Drive::parse`] gives the same drive again.
    pub fn to_toml(&self) -> String {
        toml::to_string(&write::layout(self)).expect("plain tables of numbers and texts are TOML")
    }

    /// The `[[effect]]` tables of the effects from that number on, to be put after a drive file's
    /// own text.
    pub fn effects_to_toml(&self, from: usize) -> String {
        let tables = write::effects(&self.effects[from..], self.motion);
        if tables.is_empty() {
            return String::new();
        }
        let text = toml::to_string(&BTreeMap::from([("effect", tables)]));
        format!("\n{}", text.expect("plain tables of numbers and texts are TOML"))
    }
}
