//! Lines of a text file.
//!
//! `csv::Reader` counts lines too, but takes records: above the columns of a log stand lines of free
//! text, in which one quotation mark would swallow the rows below, and the separator is found out of
//! them. So lines are taken here, and the fields of each by `csv-core`.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, ErrorKind, Read};

use super::encoding::{Decoded, decoded};
use crate::error::Error;
use crate::place::{Counted, Place};

/// No row is as long as this; a file without line ends is refused after so many bytes.
const LONGEST_LINE: usize = 1 << 20;

/// A line without its end, and its number; the first is 1.
pub(super) type Numbered = (u64, Vec<u8>);

/// Reads line by line into one buffer and counts lines and bytes.
pub(crate) struct LineReader<R: Read> {
    reader: BufReader<Decoded<R>>,
    file: String,
    line: Vec<u8>,
    /// Lines read so far.
    read: u64,
    /// Number of the line that was given last.
    given: u64,
    bytes: u64,
    /// Whether a line feed may follow the carriage return that ended the line before.
    returned: bool,
    /// Lines to be given once more.
    again: VecDeque<Numbered>,
}

impl<R: Read> LineReader<R> {
    pub(crate) fn new(reader: R, file: &str) -> Result<LineReader<R>, Error> {
        let decoded =
            decoded(reader).map_err(|source| Error::Read { file: file.to_owned(), source })?;
        Ok(LineReader {
            reader: BufReader::with_capacity(1 << 16, decoded),
            file: file.to_owned(),
            line: Vec::new(),
            read: 0,
            given: 0,
            bytes: 0,
            returned: false,
            again: VecDeque::new(),
        })
    }

    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// Bytes of text read so far.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The place of the line that was given last.
    pub(crate) fn place(&self) -> Place {
        self.place_of(self.given)
    }

    /// The place of a line of that number.
    pub(crate) fn place_of(&self, line: u64) -> Place {
        Place { file: self.file.clone(), at: line, counted: Counted::Lines }
    }

    /// Lines that were read already come once more, before those that were not.
    pub(super) fn give_again(&mut self, lines: impl IntoIterator<Item = Numbered>) {
        self.again = lines.into_iter().collect();
    }

    /// The next line without its end, blank ones left out, and its number.
    pub(crate) fn next(&mut self) -> Result<Option<(u64, &[u8])>, Error> {
        if let Some((number, line)) = self.again.pop_front() {
            (self.given, self.line) = (number, line);
            return Ok(Some((self.given, &self.line)));
        }
        loop {
            if !self.fill()? {
                return Ok(None);
            }
            if !self.line.trim_ascii().is_empty() {
                break;
            }
        }
        self.given = self.read;
        Ok(Some((self.given, &self.line)))
    }

    /// Lines end in a line feed, a carriage return or both.
    fn fill(&mut self) -> Result<bool, Error> {
        self.line.clear();
        let complete = loop {
            let buffer = match self.reader.fill_buf() {
                Ok(buffer) => buffer,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(source) => return Err(Error::Read { file: self.file.clone(), source }),
            };
            if std::mem::take(&mut self.returned) && buffer.first() == Some(&b'\n') {
                self.reader.consume(1);
                self.bytes += 1;
                continue;
            }
            let end = memchr::memchr2(b'\n', b'\r', buffer);
            self.returned = end.is_some_and(|at| buffer[at] == b'\r');
            let kept = end.unwrap_or(buffer.len());
            self.line.extend_from_slice(&buffer[..kept]);
            let taken = kept + usize::from(end.is_some());
            self.reader.consume(taken);
            self.bytes += taken as u64;
            if end.is_some() || taken == 0 {
                break end.is_some();
            }
            if self.line.len() > LONGEST_LINE {
                let place = self.place_of(self.read + 1);
                return Err(Error::EndlessLine { place, limit: LONGEST_LINE });
            }
        };
        self.read += u64::from(complete || !self.line.is_empty());
        Ok(complete || !self.line.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<(u64, String)> {
        let mut lines = LineReader::new(text, "a.csv").unwrap();
        let mut read = Vec::new();
        while let Some((number, line)) = lines.next().unwrap() {
            read.push((number, String::from_utf8(line.to_vec()).unwrap()));
        }
        read
    }

    #[test]
    fn lines_are_numbered_through_blank_ones_and_every_line_end() {
        let read = lines(b"\xef\xbb\xbfa\r\n\n  \nb\nc");
        assert_eq!(read, [(1, "a".into()), (4, "b".into()), (5, "c".into())]);
        assert_eq!(lines(b"a\rb\r\rc"), [(1, "a".into()), (2, "b".into()), (4, "c".into())]);
        let endless = vec![b'a'; 3 << 20];
        let error = LineReader::new(&endless[..], "a").unwrap().next().unwrap_err();
        assert!(matches!(error, Error::EndlessLine { .. }), "{error}");
    }

    #[test]
    fn lines_that_were_read_come_again() {
        let mut lines = LineReader::new(&b"a\nb\nc"[..], "a.csv").unwrap();
        lines.next().unwrap();
        let (number, line) = lines.next().unwrap().unwrap();
        let again = (number, line.to_vec());
        lines.give_again([again]);
        assert_eq!(lines.next().unwrap(), Some((2, &b"b"[..])));
        assert_eq!(lines.next().unwrap(), Some((3, &b"c"[..])));
        assert_eq!(lines.place().at, 3);
    }
}
