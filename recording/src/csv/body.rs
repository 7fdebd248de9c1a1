//! The rows of a file as they are taken: what is no row is told from what is.

use super::clock::{Stamp, stamp};
use super::column::{Column, Kind};
use super::encoding::text;
use super::fields::Fields;
use super::layout::Layout;
use super::number::is_missing;
use crate::error::Error;
use crate::header;
use crate::mapping::Mapping;
use crate::place::{Counted, Lines};
use crate::stretches::Stretches;

/// One row in so many may hold more values than there are names; more are another layout.
const FEW: usize = 10;

/// The rows as they are taken.
pub(super) struct Body<'a> {
    pub(super) layout: &'a Layout,
    pub(super) columns: Vec<Column>,
    pub(super) lines: Lines,
    pub(super) count: usize,
    /// The column of time, where its name tells.
    time: Option<usize>,
    /// The column of dates beside a clock.
    pub(super) date: Option<usize>,
    values: Vec<Option<f64>>,
    /// Rows with fewer values than names, and how many they lack.
    short: Stretches,
    lacking: Vec<usize>,
    last_is_short: bool,
    /// Rows with more values than names: how many, the first one's line and its values.
    long: usize,
    first_long: (u64, usize),
    /// Lines without a number.
    words: Stretches,
    read: usize,
    /// How often the header stands again among the rows.
    pub(super) repeats: usize,
}

impl<'a> Body<'a> {
    pub(super) fn new(
        layout: &'a Layout,
        kinds: Vec<Kind>,
        units: &[String],
        name: &str,
        maps: &[Mapping],
    ) -> Body<'a> {
        let clock = kinds.iter().any(|kind| matches!(kind, Kind::Clock { .. }));
        let date = kinds.iter().position(|kind| *kind == Kind::Date).filter(|_| clock);
        Body {
            layout,
            columns: kinds.into_iter().zip(units).map(|(it, unit)| Column::new(it, unit)).collect(),
            time: layout.header.iter().position(|text| header::is_signal(text, "time", maps)),
            lines: Lines::new(name, Counted::Lines),
            count: 0,
            date,
            values: Vec::new(),
            short: Stretches::default(),
            lacking: Vec::new(),
            last_is_short: false,
            long: 0,
            first_long: (0, 0),
            words: Stretches::default(),
            read: 0,
            repeats: 0,
        }
    }

    pub(super) fn reserve(&mut self, more: usize) {
        self.columns.iter_mut().for_each(|column| column.reserve(more));
    }

    pub(super) fn take(&mut self, fields: &Fields, line: u64) {
        self.read += 1;
        if fields.len() != self.columns.len() {
            self.take_with_care(fields, line);
            return;
        }
        // A number shows that the line is a row; other cells are looked at only there.
        let (mut numbers, mut others) = (false, false);
        self.values.clear();
        for (k, column) in self.columns.iter().enumerate() {
            let value = column.quick(fields.get(k));
            (numbers, others) = (numbers | value.is_some(), others | value.is_none());
            self.values.push(value);
        }
        // Beside a word in place of the time, numbers are a footer's.
        let at = self.time.filter(|at| self.values[*at].is_none());
        if !numbers || at.is_some_and(|at| !self.columns[at].fits(fields.get(at))) {
            self.take_with_care(fields, line);
            return;
        }
        self.lines.note(self.count, line);
        let day = if others { self.day(fields) } else { None };
        for (k, (column, value)) in self.columns.iter_mut().zip(&self.values).enumerate() {
            match value {
                Some(value) => column.push(*value),
                None => column.push_cell(fields.get(k), line, day),
            }
        }
        self.count += 1;
        self.last_is_short = false;
    }

    /// The date of a row, where it stands beside a clock.
    fn day(&self, fields: &Fields) -> Option<i128> {
        match stamp(&text(fields.get(self.date?)), true) {
            Some(Stamp::Day(day)) => Some(day),
            _ => None,
        }
    }

    /// A row with a gap, a clock or a word in it, or a line that is no row at all.
    fn take_with_care(&mut self, fields: &Fields, line: u64) {
        let (found, expected) = (fields.len(), self.columns.len());
        if fields.iter().all(<[u8]>::is_empty) {
            return;
        }
        if fields.iter().map(text).eq(self.layout.names.iter().map(String::as_str)) {
            self.repeats += 1;
            return;
        }
        let word = |at: usize| {
            let cell = fields.get(at);
            !is_missing(cell) && !self.columns[at].fits(cell)
        };
        if !self.columns.iter().enumerate().any(|(k, column)| column.fits(fields.get(k)))
            || self.time.is_some_and(word)
        {
            self.words.add(self.read, line);
            return;
        }
        if (expected..found).any(|k| !fields.get(k).is_empty()) {
            if self.long == 0 {
                self.first_long = (line, found);
            }
            self.long += 1;
            return;
        }
        let day = self.day(fields);
        self.lines.note(self.count, line);
        for (k, column) in self.columns.iter_mut().enumerate() {
            column.push_cell(fields.get(k), line, day);
        }
        self.last_is_short = found < expected;
        if self.last_is_short {
            self.short.add(self.count, line);
            if !self.lacking.contains(&(expected - found)) {
                self.lacking.push(expected - found);
            }
        }
        self.count += 1;
    }

    /// Says which lines are no rows, and takes an incomplete last row back.
    pub(super) fn leave_out_rows(
        &mut self,
        left_out: &mut Vec<String>,
        notes: &mut Vec<String>,
    ) -> Result<(), Error> {
        let at = |it: &Stretches| it.text(Counted::Lines);
        if self.long * FEW > self.count + self.long {
            let (line, found) = self.first_long;
            let (place, expected) = (self.lines.place_at(line), self.columns.len());
            return Err(Error::Ragged { place, found, expected });
        }
        if self.long > 0 {
            let (line, found) = self.first_long;
            let (rows, names) = (self.long, self.columns.len());
            left_out.push(format!(
                "rows with more values than the {names} names: {rows}, the first line {line} with {found}"
            ));
        }
        if !self.words.is_empty() {
            left_out.push(format!("text without numbers, {}", at(&self.words)));
        }
        let all_lack_the_same = self.short.samples == self.count && self.lacking.len() == 1;
        if self.short.is_empty() || all_lack_the_same {
            return Ok(());
        }
        if self.last_is_short {
            self.count -= 1;
            let line = self.lines.line(self.count);
            self.columns.iter_mut().for_each(Column::pop);
            left_out.push(format!("line {line}, the last one, which is not complete"));
        }
        let others = self.short.samples - usize::from(self.last_is_short);
        if others > 0 {
            let places = at(&self.short);
            notes.push(format!(
                "{others} rows lack values at their end, which count as missing, {places}"
            ));
        }
        Ok(())
    }
}
