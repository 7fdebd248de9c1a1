//! Where the header of a text file is, and what parts its columns.
//!
//! Titles, dates, settings and comments may stand above the header. The rows tell: the first run
//! of lines with numbers and of one width; the header is the last line without numbers above it
//! that has a name for every column, with a line of units below it at most.

use std::io::Read;

use super::fields::{BLANKS, DELIMITERS};
use super::layout::Layout;
use super::line::{Line, longest_run};
use super::lines::{LineReader, Numbered};
use super::names::{header_above, joined_brackets, joined_names, named, rows_are_numbered};
use super::unnamed::{nameless, names_alone};
use crate::error::Error;

/// So many rows in a run are enough to know the columns.
const ENOUGH_ROWS: usize = 100;
/// A file whose first so many lines hold no run of rows is no table.
const LONGEST_PREAMBLE: usize = 100_000;

/// The layout of a file, and the lines that were looked at for it.
pub(super) fn of_file<R: Read>(
    lines: &mut LineReader<R>,
) -> Result<(Layout, Vec<Numbered>), Error> {
    let mut seen: Vec<Numbered> = Vec::new();
    let mut run = 0;
    while run < ENOUGH_ROWS && seen.len() < LONGEST_PREAMBLE {
        let Some(line) = take(lines)? else { break };
        run = if may_be_row(&line.1) { run + 1 } else { 0 };
        seen.push(line);
    }
    let layout = of_lines(lines, &seen)?;
    Ok((layout, seen))
}

/// The layout of a stream, known with the first row or the end; its rows come again.
pub(super) fn of_stream<R: Read>(lines: &mut LineReader<R>) -> Result<Layout, Error> {
    let mut seen: Vec<Numbered> = Vec::new();
    let layout = loop {
        let Some(line) = take(lines)? else { break of_lines(lines, &seen)? };
        let (row, numbers) = (may_be_row(&line.1), is_numbers(&line.1));
        seen.push(line);
        if row {
            match of_lines(lines, &seen) {
                Ok(layout) => break layout,
                Err(error) if numbers && seen.len() == 1 || seen.len() >= LONGEST_PREAMBLE => {
                    return Err(error);
                }
                Err(_) => {}
            }
        }
    };
    lines.give_again(seen.split_off(layout.rows_from));
    Ok(layout)
}

fn take<R: Read>(lines: &mut LineReader<R>) -> Result<Option<Numbered>, Error> {
    let Some((number, line)) = lines.next()? else { return Ok(None) };
    let line = (number, line.to_vec());
    match line.1.contains(&0) {
        true => Err(Error::NotUtf8 { place: lines.place(), position: 1, byte: 0 }),
        false => Ok(Some(line)),
    }
}

/// Whether some delimiter makes a row of a line.
fn may_be_row(line: &[u8]) -> bool {
    DELIMITERS.iter().any(|delimiter| Line::of(line, *delimiter).row)
}

/// Whether a line holds nothing but numbers under some delimiter.
fn is_numbers(line: &[u8]) -> bool {
    DELIMITERS
        .iter()
        .map(|delimiter| Line::of(line, *delimiter))
        .any(|it| it.row && it.clean == 1.0)
}

/// The layout under the delimiter that explains the lines best.
fn of_lines<R: Read>(lines: &LineReader<R>, seen: &[Numbered]) -> Result<Layout, Error> {
    let empty = || Error::Empty { file: lines.file().to_owned() };
    let first = seen.first().ok_or_else(empty)?;
    let said = declared(&first.1);
    let seen = if said.is_some() { &seen[1..] } else { seen };
    let candidates: Vec<u8> = said.map_or(DELIMITERS.to_vec(), |delimiter| vec![delimiter]);
    let mut best: Option<(f64, Layout)> = None;
    let mut numbers_at = None;
    for delimiter in candidates {
        let split: Vec<Line> = seen.iter().map(|line| Line::of(&line.1, delimiter)).collect();
        let found = under(&split, seen, delimiter);
        if let Err(Some(misfit)) = found {
            numbers_at.get_or_insert(misfit);
        }
        if let Ok((score, layout)) = found
            && best.as_ref().is_none_or(|(other, _)| score > *other)
        {
            best = Some((score, layout));
        }
    }
    let mut layout = match (best, numbers_at) {
        (Some((_, layout)), _) => layout,
        (None, Some(Misfit { line, found, expected })) => {
            let place = lines.place_of(line);
            return Err(match expected {
                Some(expected) => Error::Ragged { place, found, expected },
                None => match nameless(seen) {
                    Some(layout) => return Ok(layout),
                    None if found == 1 => Error::OneValue { place },
                    None => Error::NoHeader { place },
                },
            });
        }
        (None, None) => names_alone(seen).ok_or_else(empty)?,
    };
    layout.rows_from += usize::from(said.is_some());
    layout.header_at += usize::from(said.is_some());
    Ok(layout)
}

/// The delimiter of a first line `sep=;`.
fn declared(line: &[u8]) -> Option<u8> {
    let text = line.trim_ascii_start().strip_prefix(b"sep=")?;
    match text {
        [] => None,
        [b'\\', b't', ..] => Some(b'\t'),
        [delimiter, ..] => Some(*delimiter).filter(u8::is_ascii),
    }
}

/// Rows that no line above names.
#[derive(Clone, Copy)]
struct Misfit {
    line: u64,
    /// Values in a row.
    found: usize,
    /// Names in a line above, where there is one.
    expected: Option<usize>,
}

/// The layout under one delimiter and how well it explains the lines, or the line of the numbers
/// that have no names above them.
fn under(
    split: &[Line],
    seen: &[Numbered],
    delimiter: u8,
) -> Result<(f64, Layout), Option<Misfit>> {
    let Some((width, rows, clean)) = longest_run(split) else { return Err(None) };
    if width == 1 && delimiter != b',' {
        return Err(None);
    }
    let is_row = |line: &Line| line.row && line.fields.len() == width;
    let first = split.iter().position(is_row);
    for row in (0..split.len()).filter(|k| is_row(&split[*k])) {
        let Some((header, exact)) = header_above(split, row, width, delimiter) else { continue };
        let mut layout = named(split, header, row, delimiter);
        if layout.header.is_empty() {
            continue;
        }
        if delimiter == BLANKS {
            layout.header = joined_brackets(&layout.header);
            let expected = layout.header.len();
            let Some(names) = joined_names(layout.header, width) else {
                let line = seen[row].0;
                return Err(Some(Misfit { line, found: width, expected: Some(expected) }));
            };
            layout.header = names;
        }
        if layout.header.len() + 1 == width && rows_are_numbered(split, width) {
            layout.header.insert(0, "row".to_owned());
            layout.names.insert(0, String::new());
        }
        let score = if exact { 2.0 } else { 1.0 };
        return Ok((score * (1.0 + clean * rows as f64 / split.len() as f64), layout));
    }
    Err(first.map(|at| {
        let named = |line: &&Line| line.names() && line.fields.len() > 1 && delimiter != BLANKS;
        let expected = split[..at].iter().rev().find(named).map(|line| line.fields.len());
        Misfit { line: seen[at].0, found: width, expected }
    }))
}
