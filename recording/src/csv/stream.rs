//! A recording row by row, in fixed memory: for live data from standard input.

use std::io::Read;

use super::rows::Rows;
use crate::error::Error;
use crate::header::{self, ColumnNote, Header};
use crate::mapping::ReadOptions;
use crate::time::UNIFORM;

/// Reads a recording one row at a time; names and units are settled by the header.
pub struct CsvStream<R: Read> {
    rows: Rows<R>,
    header: Header,
    time: usize,
    notes: Vec<ColumnNote>,
    raw: Vec<f64>,
    values: Vec<f64>,
    clock: Clock,
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
        let header = header::resolve(name, rows.header(), &options.columns, &[])?;
        let time = header.time.ok_or_else(|| header::missing_time(name, rows.header()))?;
        if header.columns.len() == 1 {
            return Err(Error::NoSignals { file: name.to_owned() });
        }
        let signals = header.columns.iter().enumerate().filter(|(k, _)| *k != time);
        let notes = signals.map(|(_, column)| column.note.clone()).collect();
        let (raw, values) = (Vec::new(), Vec::new());
        Ok(CsvStream { rows, header, time, notes, raw, values, clock: Clock::default() })
    }

    /// The signals of every row, in order, the time left out.
    pub fn columns(&self) -> &[ColumnNote] {
        &self.notes
    }

    /// Mean sampling time so far, s; `None` before the second row.
    pub fn period_s(&self) -> Option<f64> {
        self.clock.period_s()
    }

    /// The next row, `None` at the end.
    ///
    /// # Errors
    /// A row that is ragged or holds no numbers; a time step that departs by more than 1 % from
    /// the mean of those before it (here nothing can be resampled).
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
        let (before, mean) = (self.clock.last_s, self.clock.period_s());
        self.clock.tick(time_s);
        let step_s = time_s - before;
        let place = || self.rows.place();
        if self.clock.samples > 1 && step_s < 0.0 {
            return Err(Error::TimeBackwards { place: place(), from_s: before, to_s: time_s });
        }
        if self.clock.samples > 1 && step_s == 0.0 {
            let median_s = mean.unwrap_or(0.0);
            return Err(Error::TimeRepeated { place: place(), at_s: time_s, median_s });
        }
        match mean {
            Some(median_s) if (step_s - median_s).abs() > UNIFORM * median_s => {
                Err(Error::NonUniform { place: place(), step_s, median_s })
            }
            _ => Ok(Some(Row { line, time_s, values: &self.values })),
        }
    }
}

/// First and last time stamp: all that a mean sampling time needs.
#[derive(Debug, Default)]
struct Clock {
    first_s: f64,
    last_s: f64,
    samples: u64,
}

impl Clock {
    fn tick(&mut self, time_s: f64) {
        if self.samples == 0 {
            self.first_s = time_s;
        }
        self.last_s = time_s;
        self.samples += 1;
    }

    fn period_s(&self) -> Option<f64> {
        (self.samples > 1).then(|| (self.last_s - self.first_s) / (self.samples - 1) as f64)
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
        assert_eq!(stream.period_s(), Some(0.005));
    }

    #[test]
    fn a_step_that_departs_is_located() {
        let mut late = stream("t,u\n0,1\n0.1,1\n0.2,1\n0.32,1\n");
        for _ in 0..3 {
            late.next_row().unwrap().unwrap();
        }
        let error = late.next_row().unwrap_err();
        assert!(matches!(&error, Error::NonUniform { place, .. } if place.at == 5), "{error}");
        let mut back = stream("t,u\n0,1\n-0.1,1\n");
        back.next_row().unwrap();
        assert!(matches!(back.next_row().unwrap_err(), Error::TimeBackwards { .. }));
        let mut twice = stream("t,u\n0,1\n0,1\n");
        twice.next_row().unwrap();
        assert!(matches!(twice.next_row().unwrap_err(), Error::TimeRepeated { .. }));
    }
}
