//! Text: its reader and writer are in the module `csv`.

use std::fs::File;

use super::Format;
use crate::csv;
use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::table::Table;

/// Text has no first bytes of its own: what is text and nothing else is taken as CSV.
pub(super) static FORMAT: Format = Format {
    name: "CSV",
    extensions: &["csv", "txt", "tsv", "log", "dat", "asc"],
    starts: |_| false,
    read,
    write: Some(|out, recording| csv::write(out, recording)),
};

fn read(opened: File, file: &str, options: &ReadOptions) -> Result<Table, Error> {
    let about = opened.metadata().ok().filter(std::fs::Metadata::is_file);
    csv::table(opened, file, about.map(|it| it.len()), options)
}
