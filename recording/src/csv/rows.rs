//! Rows of numbers, one at a time, in memory that does not grow: for live data.

use std::io::Read;

use super::encoding::text;
use super::fields::Fields;
use super::first_lines;
use super::layout::Layout;
use super::lines::LineReader;
use super::number::{LONGEST_NUMBER, number};
use crate::error::Error;
use crate::place::Place;

/// Reads rows as plain numbers, without regard to names and units.
pub(super) struct Rows<R: Read> {
    lines: LineReader<R>,
    fields: Fields,
    layout: Layout,
}

impl<R: Read> Rows<R> {
    /// Reads the header and not a row more than it takes to know it.
    pub(super) fn new(reader: R, file: &str) -> Result<Rows<R>, Error> {
        let mut lines = LineReader::new(reader, file)?;
        let layout = first_lines::of_stream(&mut lines)?;
        Ok(Rows { lines, fields: Fields::new(layout.delimiter), layout })
    }

    pub(super) fn header(&self) -> &[String] {
        &self.layout.header
    }

    /// The place of the row that was read last.
    pub(super) fn place(&self) -> Place {
        self.lines.place()
    }

    /// Puts the next row into `values` and returns its line; `None` at the end.
    pub(super) fn next_into(&mut self, values: &mut Vec<f64>) -> Result<Option<u64>, Error> {
        values.clear();
        let number_of_line = loop {
            match self.lines.next()? {
                None => return Ok(None),
                Some((_, line)) if self.layout.is_comment(line) => {}
                Some((number, line)) => {
                    self.fields.split(line);
                    break number;
                }
            }
        };
        let expected = self.layout.header.len();
        let found = self.fields.len();
        let more = (expected..found).any(|k| !self.fields.get(k).is_empty());
        if found < expected || more {
            return Err(Error::Ragged { place: self.place(), found, expected });
        }
        for k in 0..expected {
            match number(self.fields.get(k)) {
                Some(value) => values.push(value),
                None => return Err(self.not_a_number(k)),
            }
        }
        Ok(Some(number_of_line))
    }

    fn not_a_number(&self, k: usize) -> Error {
        Error::NotANumber {
            place: self.place(),
            position: k + 1,
            column: self.layout.header[k].clone(),
            text: text(self.fields.get(k)).chars().take(LONGEST_NUMBER).collect(),
        }
    }
}
