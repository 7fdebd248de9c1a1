//! Recordings as CSV: read at once, read row by row, written.
//!
//! Other formats that are text take its lines, in any encoding and with their places, from
//! [`lines::LineReader`], and numbers from [`number`].

mod body;
mod clock;
mod column;
mod encoding;
mod fields;
mod first_lines;
mod kinds;
mod layout;
mod line;
pub(crate) mod lines;
mod names;
pub(crate) mod number;
mod rows;
mod settings;
mod stream;
mod unnamed;
mod whole;
mod write;

pub use stream::{CsvStream, Row};
pub(crate) use write::{write, write_with_texts};

use std::io::Read;

use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::report::Report;
use crate::signal::Recording;
use crate::table::Table;

/// Reads a whole recording from CSV text; `name` stands for it in messages.
///
/// UTF-8, UTF-16 or Windows-1252; parted by semicolon, tab, bar, comma or blanks, with a decimal
/// point or comma; titles and settings may stand above the header. Empty fields, `NaN`, `NA` and
/// `null` are missing values and become NaN; columns of text are left out with a word.
///
/// # Errors
/// Any of [`Error`] that concerns text, columns or time; `name:line` is named.
pub fn read_csv(
    reader: impl Read,
    name: &str,
    options: &ReadOptions,
) -> Result<(Recording, Report), Error> {
    table(reader, name, None, options)?.into_recording(options)
}

/// The columns of a CSV text; with its size, memory is asked for once.
pub(crate) fn table(
    reader: impl Read,
    name: &str,
    bytes: Option<u64>,
    options: &ReadOptions,
) -> Result<Table, Error> {
    whole::read(reader, name, bytes, options)
}
