//! Formats of recordings: one file a format, one line a format in the registry below.
//!
//! Reading a file, the errors about unknown files and the page's file picker follow this list; a test
//! holds the README's sentence to it.

// Without the large formats some of what they share has no other user.
#![cfg_attr(not(feature = "containers"), allow(dead_code))]

mod csv;
#[cfg(feature = "containers")]
mod excel;
#[cfg(feature = "containers")]
mod hdf5;
mod mat;
mod mdf;
#[cfg(feature = "containers")]
mod parquet;
mod rates;
mod recognise;
mod tdms;
mod tree;

use std::fs::File;
use std::io::{self, BufWriter};

use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::signal::Recording;
use crate::table::Table;

pub(crate) use recognise::{by_extension, recognise};

/// Every format that is read, in the order in which people are told of them.
static FORMATS: &[&Format] = &[
    &csv::FORMAT,
    #[cfg(feature = "containers")]
    &parquet::FORMAT,
    #[cfg(feature = "containers")]
    &excel::FORMAT,
    &mat::FORMAT,
    #[cfg(feature = "containers")]
    &hdf5::FORMAT,
    &tdms::FORMAT,
    &mdf::FORMAT,
];

/// A format of recordings.
#[derive(Debug)]
pub struct Format {
    /// As people call it.
    pub name: &'static str,
    /// Extensions of its files, in lower case and without the dot; the usual one first.
    pub extensions: &'static [&'static str],
    /// Whether a file that begins with these bytes, its first 4096 or all, is one. Formats are asked
    /// in the order of the list, and only what none of them knows can be text.
    pub(crate) starts: fn(&[u8]) -> bool,
    /// Reads a file's columns.
    pub(crate) read: fn(File, &str, &ReadOptions) -> Result<Table, Error>,
    /// Writes a recording, where that is offered.
    pub(crate) write: Option<Write>,
}

/// Writes a recording's content.
pub(crate) type Write = fn(&mut BufWriter<&File>, &Recording) -> io::Result<()>;

/// The formats of recordings that [`read`](crate::read()) understands.
pub fn formats() -> &'static [&'static Format] {
    FORMATS
}

/// The formats with their extensions, for a sentence: `CSV (.csv, .txt), Parquet (.parquet)`.
pub fn formats_listed() -> String {
    let listed = FORMATS.iter().map(|it| format!("{} ({})", it.name, dotted(it)));
    listed.collect::<Vec<_>>().join(", ")
}

/// The usual extensions of the formats that are written: `.csv or .parquet`.
pub(crate) fn written() -> String {
    let written = FORMATS.iter().filter(|it| it.write.is_some());
    written.map(|it| format!(".{}", it.extensions[0])).collect::<Vec<_>>().join(" or ")
}

fn dotted(format: &Format) -> String {
    format.extensions.iter().map(|it| format!(".{it}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_formats_share_an_extension() {
        let mut all: Vec<_> = FORMATS.iter().flat_map(|it| it.extensions).collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
        assert!(all.iter().all(|it| it.chars().all(|c| c.is_ascii_lowercase() || c.is_numeric())));
    }

    #[test]
    fn the_readme_lists_them() {
        let readme = include_str!("../../../README.md");
        let words = readme.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(&formats_listed()), "the README lacks: {}", formats_listed());
    }

    #[test]
    fn csv_and_parquet_are_written() {
        assert_eq!(written(), ".csv or .parquet");
    }
}
