//! A sheet as the CSV text of the table in it.

use std::collections::VecDeque;
use std::io::{self, Read};

use super::cells::{Cell, Row};

/// Rows above the numbers that are looked at.
const MOST_ABOVE: usize = 200;
/// Names in a header, at least: a time and a signal.
const FEWEST: usize = 2;
/// Digits after the point of a second that a date holds: it counts days in 15 digits.
const MICROSECONDS: f64 = 1e6;

/// A column of the table.
struct Column {
    /// Which cell of a row.
    at: usize,
    name: String,
    /// The first moment of a column of dates.
    first: Option<f64>,
}

/// Gives the table as text, row by row.
pub(super) struct SheetText<I> {
    rows: I,
    /// Rows that were read to find the table, the row of names first.
    above: VecDeque<Row>,
    columns: Vec<Column>,
    /// Columns of words.
    words: Vec<String>,
    /// The line that is given next.
    line: u32,
    text: Vec<u8>,
    given: usize,
    failed: Option<String>,
}

impl<I: Iterator<Item = Result<Row, String>>> SheetText<I> {
    /// The first row of names above rows of numbers; `None` where there is none.
    pub(super) fn find(mut rows: I) -> Result<Option<SheetText<I>>, String> {
        let mut above: VecDeque<Row> = VecDeque::new();
        for row in rows.by_ref().take(MOST_ABOVE) {
            let row = row?;
            let values = row.cells.iter().filter(|it| it.is_value()).count();
            above.push_back(row);
            if values < FEWEST {
                continue;
            }
            let Some(sample) = above.back() else { continue };
            // The names are the row just above, or the one above a row of units: that with more.
            let named = |row: &&Row| named(row, sample) >= FEWEST;
            let last = above.iter().rev().skip(1).take(2).filter(named);
            let Some(header) = last.max_by_key(|row| self::named(row, sample)) else { continue };
            let number = header.number;
            let (columns, words) = columns(header, sample);
            above.retain(|row| row.number >= number);
            let sheet = SheetText {
                rows,
                above,
                columns,
                words,
                line: 0,
                text: Vec::new(),
                given: 0,
                failed: None,
            };
            return Ok(Some(sheet));
        }
        Ok(None)
    }

    /// Columns that hold words.
    pub(super) fn left_out(&self) -> Vec<String> {
        self.words.iter().map(|it| format!("column `{it}` holds text")).collect()
    }

    /// Why the text ended early.
    pub(super) fn failed(&mut self) -> Option<String> {
        self.failed.take()
    }

    /// Puts the next row into the buffer; false at the end.
    fn next(&mut self) -> bool {
        let header = self.line == 0;
        let row = match self.above.pop_front().map(Ok).or_else(|| self.rows.next()) {
            None => return false,
            Some(Ok(row)) => row,
            Some(Err(what)) => {
                self.failed = Some(what);
                return false;
            }
        };
        self.text.clear();
        self.given = 0;
        // Rows of the sheet that are empty are empty lines, so that line and row agree.
        let blank = row.number.saturating_sub(self.line);
        self.text.resize(blank as usize, b'\n');
        self.line = row.number + 1;
        let fields: Vec<String> = match header {
            true => self.columns.iter().map(|it| it.name.clone()).collect(),
            false => self.columns.iter_mut().map(|it| it.field(&row)).collect(),
        };
        if fields.iter().any(|it| !it.is_empty()) {
            self.text.extend_from_slice(fields.join("\t").as_bytes());
        }
        self.text.push(b'\n');
        true
    }
}

impl<I: Iterator<Item = Result<Row, String>>> Read for SheetText<I> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.given == self.text.len() {
            if !self.next() {
                return Ok(0);
            }
        }
        let rest = &self.text[self.given..];
        let count = rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        self.given += count;
        Ok(count)
    }
}

/// Cells with a text above a value of the first sample.
fn named(row: &Row, sample: &Row) -> usize {
    let pairs = row.cells.iter().zip(&sample.cells);
    pairs.filter(|(name, value)| matches!(name, Cell::Text(_)) && value.is_value()).count()
}

/// The columns that have a name, and the names of those that hold words.
fn columns(header: &Row, sample: &Row) -> (Vec<Column>, Vec<String>) {
    let (mut columns, mut words) = (Vec::new(), Vec::new());
    for (at, cell) in header.cells.iter().enumerate() {
        let Cell::Text(name) = cell else { continue };
        let name = plain(name).trim_start_matches('#').trim().replace(';', ",");
        match sample.cells.get(at).unwrap_or(&Cell::Empty) {
            _ if name.is_empty() => {}
            Cell::Text(text) if !looks_numeric(text) => words.push(name),
            Cell::Moment(first) => {
                columns.push(Column { at, name: in_seconds(&name), first: Some(*first) });
            }
            Cell::Duration(_) => columns.push(Column { at, name: in_seconds(&name), first: None }),
            Cell::Number(_) | Cell::Text(_) | Cell::Empty => {
                columns.push(Column { at, name, first: None });
            }
        }
    }
    (columns, words)
}

impl Column {
    /// The cell as CSV has it.
    fn field(&mut self, row: &Row) -> String {
        match row.cells.get(self.at).unwrap_or(&Cell::Empty) {
            Cell::Empty => String::new(),
            Cell::Number(value) | Cell::Duration(value) => value.to_string(),
            Cell::Moment(at) => {
                let since = at - self.first.unwrap_or(0.0);
                ((since * MICROSECONDS).round() / MICROSECONDS).to_string()
            }
            // The unit of a date is the second, whatever the sheet calls it.
            Cell::Text(_) if self.first.is_some() => String::new(),
            Cell::Text(text) => plain(text),
        }
    }
}

/// A text without what would separate fields or lines.
fn plain(text: &str) -> String {
    text.replace(['\t', '\n', '\r'], " ").replace('"', "'").trim().to_owned()
}

fn looks_numeric(text: &str) -> bool {
    let text = text.trim();
    let missing = ["", "na", "n/a", "nan", "null"];
    missing.contains(&text.to_lowercase().as_str()) || text.replace(',', ".").parse::<f64>().is_ok()
}

/// The name with seconds as its unit, in place of a writing such as `[hh:mm:ss]`.
fn in_seconds(name: &str) -> String {
    let bare = name.split(['[', '(']).next().unwrap_or(name).trim();
    format!("{} [s]", if bare.is_empty() { "time" } else { bare })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(rows: Vec<(u32, Vec<Cell>)>) -> Option<(String, Vec<String>)> {
        let rows = rows.into_iter().map(|(number, cells)| Ok(Row { number, cells }));
        let mut sheet = SheetText::find(rows).unwrap()?;
        let mut text = String::new();
        sheet.read_to_string(&mut text).unwrap();
        Some((text, sheet.left_out()))
    }

    fn words(texts: &[&str]) -> Vec<Cell> {
        texts.iter().map(|it| Cell::Text((*it).to_owned())).collect()
    }

    #[test]
    fn a_table_is_found_below_titles_and_beside_notes() {
        use Cell::{Empty, Moment, Number, Text};
        let at = |k: f64| vec![Empty, Moment(9e9 + k), Number(0.1 * k), Text("ok".into())];
        let mut header = words(&["", "Time [hh:mm:ss]", "u", "state"]);
        header[0] = Empty;
        let mut units = words(&["", "[hh:mm:ss]", "V", ""]);
        units[0] = Empty;
        let rows = vec![
            (0, words(&["Motor", "test"])),
            (2, header),
            (3, units),
            (4, at(0.0)),
            (6, at(0.5)),
        ];
        let (text, left_out) = text(rows).unwrap();
        assert_eq!(text, "\n\nTime [s]\tu\n\tV\n0\t0\n\n0.5\t0.05\n");
        assert_eq!(left_out, ["column `state` holds text"]);
    }

    #[test]
    fn a_sheet_of_words_or_of_bare_numbers_holds_no_table() {
        assert!(text(vec![(0, words(&["a", "b"])), (1, words(&["c", "d"]))]).is_none());
        assert!(text(vec![(0, vec![Cell::Number(1.0), Cell::Number(2.0)])]).is_none());
    }
}
