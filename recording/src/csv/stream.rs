//! A recording row by row, in fixed memory: for live data from standard input.

use std::io::Read;

use super::rows::Rows;
use crate::error::Error;
use crate::header::{self, ColumnNote, Header};
use crate::mapping::ReadOptions;

/// Reads a recording one row at a time; names and units are settled by the header.
pub struct CsvStream<R: Read> {
    rows: Rows<R>,
    header: Header,
    time: usize,
    notes: Vec<ColumnNote>,
    raw: Vec<f64>,
    values: Vec<f64>,
}

/// One sample of every signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row<'a> {
    /// Line in the file, the first is 1.
    pub line: u64,
    /// Time of the sample, s.
    pub time_s: f64,
    /// One value a signal, in the order and the units of [`CsvStream::columns`].
    pub values: &'a [f64],
}

impl<R: Read> CsvStream<R> {
    /// Reads the header; `name` stands for the stream in messages.
    ///
    /// # Errors
    /// As [`super::read_csv`] for the header.
    pub fn new(reader: R, name: &str, options: &ReadOptions) -> Result<CsvStream<R>, Error> {
        let rows = Rows::new(reader, name)?;
        let header = header::resolve(name, rows.header(), options, &[])?;
        let time = header.time.ok_or_else(|| header::missing_time(name, rows.header()))?;
        if header.columns.len() == 1 {
            return Err(Error::NoSignals { file: name.to_owned() });
        }
        let signals = header.columns.iter().enumerate().filter(|(k, _)| *k != time);
        let notes = signals.map(|(_, column)| column.note.clone()).collect();
        let (raw, values) = (Vec::new(), Vec::new());
        Ok(CsvStream { rows, header, time, notes, raw, values })
    }

    /// The signals of every row, in order, the time left out.
    pub fn columns(&self) -> &[ColumnNote] {
        &self.notes
    }

    /// The next row, `None` at the end; whether its time is where it should be is the caller's to
    /// judge.
    ///
    /// # Errors
    /// A row that is ragged, or holds no numbers, or no time: after an error that
    /// [is of a row](Error::is_of_row) the next call takes the next row.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>, Error> {
        let Some(line) = self.rows.next_into(&mut self.raw)? else { return Ok(None) };
        let time_s = self.header.columns[self.time].convert(self.raw[self.time]);
        self.values.clear();
        for (k, column) in self.header.columns.iter().enumerate().filter(|(k, _)| *k != self.time) {
            self.values.push(column.convert(self.raw[k]));
        }
        if !time_s.is_finite() {
            return Err(Error::TimeNotFinite { place: self.rows.place() });
        }
        Ok(Some(Row { line, time_s, values: &self.values }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(text: &str) -> CsvStream<&[u8]> {
        CsvStream::new(text.as_bytes(), "-", &ReadOptions::default()).unwrap()
    }

    #[test]
    fn rows_arrive_converted_and_located() {
        let mut stream = stream("u [mV],time [ms],Speed [rpm]\n1500,0,30\n\n1600,5,60\n");
        let names: Vec<_> = stream.columns().iter().map(|it| it.signal.as_str()).collect();
        assert_eq!(names, ["u", "omega"]);
        let first = stream.next_row().unwrap().unwrap();
        assert_eq!((first.line, first.time_s, first.values[0]), (2, 0.0, 1.5));
        let second = stream.next_row().unwrap().unwrap();
        assert_eq!((second.line, second.time_s, second.values[0]), (4, 0.005, 1.6));
        assert_eq!(second.values[1], 60.0 * std::f64::consts::PI / 30.0);
        assert_eq!(stream.next_row().unwrap(), None);
    }

    #[test]
    fn a_row_that_is_none_is_passed_over() {
        let mut stream = stream("t,u\n0,1\n0.1\nt,u\n,5\n0.2,x\n0.05,nan\n");
        assert_eq!(stream.next_row().unwrap().unwrap().time_s, 0.0);
        for line in 3..=6 {
            let error = stream.next_row().unwrap_err();
            assert!(
                error.is_of_row() && error.to_string().contains(&format!(":{line}")),
                "{error}"
            );
        }
        let last = stream.next_row().unwrap().unwrap();
        assert!((last.line, last.time_s) == (7, 0.05) && last.values[0].is_nan());
        assert_eq!(stream.next_row().unwrap(), None);
    }
}
