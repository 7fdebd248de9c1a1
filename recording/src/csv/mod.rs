//! Recordings as CSV: read at once, read row by row, written.

mod lines;
mod preamble;
mod rows;
mod stream;
mod write;

pub use stream::{CsvStream, Row};
pub(crate) use write::write;

use std::io::Read;

use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::place::{Counted, Lines};
use crate::report::Report;
use crate::signal::Recording;
use crate::table::Table;
use rows::Rows;

/// Rows after which their mean length tells how many are to come.
const ROWS_TO_ESTIMATE: usize = 1000;

/// Reads a whole recording from CSV text; `name` stands for it in messages.
///
/// Comma, semicolon or tab separated, with a decimal comma where the separator allows it; empty
/// fields, `NaN`, `NA` and `null` are missing values and become NaN.
///
/// # Errors
/// Any of [`Error`] that concerns text, columns or time; `name:line` is named.
pub fn read_csv(
    reader: impl Read,
    name: &str,
    options: &ReadOptions,
) -> Result<(Recording, Report), Error> {
    read_sized(reader, name, None, options)
}

/// As [`read_csv`], with the file's size so that memory is asked for once.
pub(crate) fn read_sized(
    reader: impl Read,
    name: &str,
    bytes: Option<u64>,
    options: &ReadOptions,
) -> Result<(Recording, Report), Error> {
    let mut rows = Rows::new(reader, name)?;
    let width = rows.header().len();
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); width];
    let mut lines = Lines::new(name, Counted::Lines);
    let mut values = Vec::with_capacity(width);
    let mut count = 0;
    while let Some(line) = rows.next_into(&mut values)? {
        lines.note(count, line);
        for (column, value) in columns.iter_mut().zip(&values) {
            column.push(*value);
        }
        count += 1;
        if count == ROWS_TO_ESTIMATE
            && let Some(bytes) = bytes
        {
            let total = (bytes as f64 / rows.bytes_read() as f64 * count as f64) as usize;
            // One in a hundred more than expected: later numbers may be written shorter.
            let more = (total + total / 100).saturating_sub(count);
            columns.iter_mut().for_each(|column| column.reserve_exact(more));
        }
    }
    let header = rows.into_header();
    Table { header, columns, lines, left_out: Vec::new(), period_s: None }.into_recording(options)
}
