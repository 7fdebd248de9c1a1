//! Workbooks: Excel (.xlsx) and OpenDocument (.ods).
//!
//! The first sheet that holds a table is read: a row of names, and below it, perhaps after a row
//! of units, rows of numbers. Its cells go the way of a CSV text, so that units, missing values
//! and decimal commas mean the same; a line number is the row's in the sheet.

mod cells;
mod sheet;
mod size;

use std::fs::File;
use std::io::{BufReader, Seek};

use calamine::{Ods, Reader, Xlsx};

use super::Format;
use crate::csv;
use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::table::Table;
use cells::{Cell, Row};
use sheet::SheetText;

pub(super) static FORMAT: Format = Format {
    name: "Excel",
    extensions: &["xlsx", "xlsm", "ods"],
    starts: |head| head.starts_with(b"PK\x03\x04") || head.starts_with(COMPOUND),
    read,
    write: None,
};

/// The first bytes of a compound file, in which .xls files are kept.
const COMPOUND: &[u8] = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1";

fn read(mut opened: File, file: &str, options: &ReadOptions) -> Result<Table, Error> {
    let failed = |source| Error::Read { file: file.to_owned(), source };
    let mut start = [0; 8];
    let compound = std::io::Read::read_exact(&mut opened, &mut start).is_ok() && start == COMPOUND;
    opened.rewind().map_err(failed)?;
    if compound {
        // Its reader asks for all cells between the corners of a sheet at once, whatever they
        // say: one wrong byte is 25 GB.
        return Err(Error::Variety {
            file: file.to_owned(),
            what: "a workbook of Excel 97 (.xls)".to_owned(),
            instead: "save it as .xlsx",
        });
    }
    let content = size::check(&opened, file)?;
    opened.rewind().map_err(failed)?;
    let reader = BufReader::new(opened);
    match content {
        size::Content::Sheets => {
            of_streams(Xlsx::new(reader).map_err(|it| damaged(file, &it))?, file, options)
        }
        size::Content::OpenDocument => {
            of_ranges(&mut Ods::new(reader).map_err(|it| damaged(file, &it))?, file, options)
        }
    }
}

/// Sheets that are held as a whole.
fn of_ranges<B: Reader<BufReader<File>>>(
    book: &mut B,
    file: &str,
    options: &ReadOptions,
) -> Result<Table, Error> {
    for (_, range) in book.worksheets() {
        let first = range.start().map_or(0, |(row, _)| row);
        let rows = range.rows().zip(first..).map(|(cells, number)| {
            Ok(Row { number, cells: cells.iter().map(Cell::from).collect() })
        });
        if let Some(table) = of_rows(rows, file, options)? {
            return Ok(table);
        }
    }
    Err(no_table(file))
}

/// Sheets that are read cell by cell: a sheet may be much larger than what is used of it.
fn of_streams(
    mut book: Xlsx<BufReader<File>>,
    file: &str,
    options: &ReadOptions,
) -> Result<Table, Error> {
    for name in book.sheet_names() {
        // A sheet that holds a chart alone has no cells.
        let Ok(cells) = book.worksheet_cells_reader(&name) else { continue };
        if let Some(table) = of_rows(cells::Rows::new(cells), file, options)? {
            return Ok(table);
        }
    }
    Err(no_table(file))
}

/// The table in a sheet's rows, if there is one.
fn of_rows(
    rows: impl Iterator<Item = Result<Row, String>>,
    file: &str,
    options: &ReadOptions,
) -> Result<Option<Table>, Error> {
    let text = SheetText::find(rows).map_err(|what| damaged(file, &what))?;
    let Some(mut text) = text else { return Ok(None) };
    let left_out = text.left_out();
    let read = csv::table(&mut text, file, None, options);
    // What went wrong in the sheet says more than the text that ends early.
    if let Some(what) = text.failed() {
        return Err(damaged(file, &what));
    }
    let mut table = read?;
    table.left_out.extend(left_out);
    Ok(Some(table))
}

fn damaged(file: &str, what: &impl std::fmt::Display) -> Error {
    Error::Damaged { file: file.to_owned(), format: FORMAT.name, what: what.to_string() }
}

fn no_table(file: &str) -> Error {
    let found = "sheets without a row of names above rows of numbers".to_owned();
    Error::NoSeries { file: file.to_owned(), found }
}
