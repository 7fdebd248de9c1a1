//! Lines of a text file and the fields in a line.

use std::io::{BufRead, BufReader, ErrorKind, Read};

use crate::error::Error;
use crate::place::{Counted, Place};

/// No row is as long as this; a file without line ends is refused after so many bytes.
const LONGEST_LINE: usize = 1 << 20;

/// Reads line by line into one buffer and counts lines and bytes.
pub(super) struct LineReader<R: Read> {
    reader: BufReader<R>,
    file: String,
    line: Vec<u8>,
    number: u64,
    bytes: u64,
    /// Whether the line is to be given once more.
    again: bool,
}

impl<R: Read> LineReader<R> {
    pub(super) fn new(reader: R, file: &str) -> LineReader<R> {
        let (reader, file) = (BufReader::with_capacity(1 << 16, reader), file.to_owned());
        LineReader { reader, file, line: Vec::new(), number: 0, bytes: 0, again: false }
    }

    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// Bytes read so far.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The place of the line that was read last.
    pub(super) fn place(&self) -> Place {
        Place { file: self.file.clone(), at: self.number, counted: Counted::Lines }
    }

    /// The line that was read last is given by the next call of [`LineReader::next`] again.
    pub(super) fn give_again(&mut self) {
        self.again = true;
    }

    /// The next line without its end, blank ones left out, and its number.
    pub(super) fn next(&mut self) -> Result<Option<(u64, &[u8])>, Error> {
        if !std::mem::take(&mut self.again) {
            loop {
                if !self.fill()? {
                    return Ok(None);
                }
                if !self.line.trim_ascii().is_empty() {
                    break;
                }
            }
        }
        Ok(Some((self.number, &self.line)))
    }

    fn fill(&mut self) -> Result<bool, Error> {
        self.line.clear();
        let complete = loop {
            let buffer = match self.reader.fill_buf() {
                Ok(buffer) => buffer,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(source) => return Err(Error::Read { file: self.file.clone(), source }),
            };
            let end = memchr::memchr(b'\n', buffer).map(|at| at + 1);
            let taken = end.unwrap_or(buffer.len());
            self.line.extend_from_slice(&buffer[..taken]);
            self.reader.consume(taken);
            self.bytes += taken as u64;
            if end.is_some() || taken == 0 {
                break end.is_some();
            }
            if self.line.len() > LONGEST_LINE {
                self.number += 1;
                return Err(Error::EndlessLine { place: self.place(), limit: LONGEST_LINE });
            }
        };
        if self.line.is_empty() {
            return Ok(false);
        }
        self.number += 1;
        if complete {
            self.line.pop();
        }
        if self.line.last() == Some(&b'\r') {
            self.line.pop();
        }
        if self.line.contains(&b'\r') {
            return Err(Error::LoneReturn { place: self.place() });
        }
        if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
        Ok(true)
    }
}

/// Splits lines at a delimiter, outside quotes, into buffers that are used again.
pub(super) struct Fields {
    splitter: csv_core::Reader,
    text: Vec<u8>,
    ends: Vec<usize>,
    count: usize,
}

impl Fields {
    pub(super) fn new(delimiter: u8) -> Fields {
        let splitter = csv_core::ReaderBuilder::new()
            .delimiter(delimiter)
            .terminator(csv_core::Terminator::Any(b'\n'))
            .build();
        Fields { splitter, text: Vec::new(), ends: Vec::new(), count: 0 }
    }

    /// Splits one line, given without its end.
    pub(super) fn split(&mut self, line: &[u8]) {
        if self.text.len() <= line.len() {
            // A field may be empty, so there can be one more than there are bytes.
            self.text.resize(line.len() + 1, 0);
            self.ends.resize(line.len() + 2, 0);
        }
        self.splitter.reset();
        let (_, _, written, ended) =
            self.splitter.read_record(line, &mut self.text, &mut self.ends);
        // The end of input ends the last field.
        let (_, _, _, last) =
            self.splitter.read_record(&[], &mut self.text[written..], &mut self.ends[ended..]);
        self.count = ended + last;
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Field `k` without blanks around it; empty beyond the last.
    pub(super) fn get(&self, k: usize) -> &[u8] {
        if k >= self.count {
            return &[];
        }
        let start = if k == 0 { 0 } else { self.ends[k - 1] };
        self.text[start..self.ends[k]].trim_ascii()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_numbered_through_blank_ones_and_every_line_end() {
        let text = b"\xef\xbb\xbfa\r\n\n  \nb\nc";
        let mut lines = LineReader::new(&text[..], "a.csv");
        let mut read = Vec::new();
        while let Some((number, line)) = lines.next().unwrap() {
            read.push((number, String::from_utf8(line.to_vec()).unwrap()));
        }
        assert_eq!(read, [(1, "a".into()), (4, "b".into()), (5, "c".into())]);
        assert!(LineReader::new(&b"a\rb\rc"[..], "a").next().is_err());
        let endless = vec![b'a'; 3 << 20];
        let error = LineReader::new(&endless[..], "a").next().unwrap_err();
        assert!(matches!(error, Error::EndlessLine { .. }), "{error}");
    }

    #[test]
    fn fields_split_outside_quotes() {
        let mut fields = Fields::new(b',');
        for (line, expected) in [
            ("a, b ,c", vec!["a", "b", "c"]),
            ("\"1,5\",2", vec!["1,5", "2"]),
            (",,", vec!["", "", ""]),
            ("a", vec!["a"]),
            ("\"x\"\"y\",", vec!["x\"y", ""]),
        ] {
            fields.split(line.as_bytes());
            let read: Vec<_> = (0..fields.len()).map(|k| fields.get(k)).collect();
            assert_eq!(read, expected.iter().map(|it| it.as_bytes()).collect::<Vec<_>>(), "{line}");
        }
    }
}
