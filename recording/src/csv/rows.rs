//! Rows of numbers, one at a time, in memory that does not grow.

use std::io::Read;

use super::lines::{Fields, LineReader};
use super::preamble::Preamble;
use crate::error::Error;
use crate::place::Place;

/// Longest text of a number: 17 digits, sign, point and exponent need 24; zeros may be padded.
const LONGEST_NUMBER: usize = 64;

/// Reads rows as plain numbers, without regard to names and units.
pub(super) struct Rows<R: Read> {
    lines: LineReader<R>,
    fields: Fields,
    header: Vec<String>,
    trailing: bool,
}

impl<R: Read> Rows<R> {
    /// Reads the header; the rows are still to come.
    pub(super) fn new(reader: R, file: &str) -> Result<Rows<R>, Error> {
        let mut lines = LineReader::new(reader, file);
        let Preamble { header, delimiter, trailing } = Preamble::read(&mut lines)?;
        Ok(Rows { lines, fields: Fields::new(delimiter), header, trailing })
    }

    pub(super) fn header(&self) -> &[String] {
        &self.header
    }

    pub(super) fn into_header(self) -> Vec<String> {
        self.header
    }

    /// Bytes read so far, the header's too.
    pub(super) fn bytes_read(&self) -> u64 {
        self.lines.bytes()
    }

    /// The place of the row that was read last.
    pub(super) fn place(&self) -> Place {
        self.lines.place()
    }

    /// Puts the next row into `values` and returns its line; `None` at the end.
    pub(super) fn next_into(&mut self, values: &mut Vec<f64>) -> Result<Option<u64>, Error> {
        values.clear();
        let number = loop {
            match self.lines.next()? {
                None => return Ok(None),
                Some((_, line)) if line.trim_ascii_start().starts_with(b"#") => {}
                Some((number, line)) => {
                    self.fields.split(line);
                    break number;
                }
            }
        };
        let mut found = self.fields.len();
        if self.trailing && found == self.header.len() + 1 && self.fields.get(found - 1).is_empty()
        {
            found -= 1;
        }
        let expected = self.header.len();
        if found != expected {
            return Err(Error::Ragged { place: self.place(), found, expected });
        }
        for k in 0..expected {
            match self::number(self.fields.get(k)) {
                Some(value) => values.push(value),
                None => return Err(self.not_a_number(k)),
            }
        }
        Ok(Some(number))
    }

    fn not_a_number(&self, k: usize) -> Error {
        let (field, place, position) = (self.fields.get(k), self.place(), k + 1);
        match std::str::from_utf8(field) {
            Ok(text) => Error::NotANumber {
                place,
                position,
                column: self.header[k].clone(),
                text: text.chars().take(LONGEST_NUMBER).collect(),
            },
            Err(error) => Error::NotUtf8 { place, position, byte: field[error.valid_up_to()] },
        }
    }
}

/// The number that a field holds, NaN where it holds none on purpose.
pub(super) fn number(field: &[u8]) -> Option<f64> {
    if let Some(value) = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok()) {
        return Some(value);
    }
    let missing = [&b""[..], b"na", b"n/a", b"null"];
    if missing.iter().any(|word| field.eq_ignore_ascii_case(word)) {
        return Some(f64::NAN);
    }
    // A decimal comma: it can only be inside a field where it does not separate fields.
    let comma = field.iter().position(|byte| *byte == b',')?;
    let mut text = [0; LONGEST_NUMBER];
    let text = text.get_mut(..field.len())?;
    text.copy_from_slice(field);
    text[comma] = b'.';
    std::str::from_utf8(text).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_every_writing() {
        for (text, value) in
            [("1.5", 1.5), ("-2e-3", -2e-3), ("1,5", 1.5), ("-1,5e2", -150.0), ("+3", 3.0)]
        {
            assert_eq!(number(text.as_bytes()), Some(value), "{text}");
        }
        for missing in ["", "NaN", "nan", "NA", "null"] {
            assert!(number(missing.as_bytes()).is_some_and(f64::is_nan), "{missing}");
        }
        for text in ["abc", "1.234,5", "1,234,5", "1 2", "0x10", "#DIV/0!", "12:30"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }
}
