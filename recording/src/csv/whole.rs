//! A whole file as columns: what is no row is left out with a word, what is no number set aside.

use std::io::Read;

use super::clock::{Stamp, stamp};
use super::column::{Column, Kind, Outcome};
use super::encoding::text;
use super::fields::Fields;
use super::kinds::kinds;
use super::layout::{self, Layout};
use super::lines::LineReader;
use super::number::is_missing;
use super::settings::{Setting, counts_a_revolution, period_s, settings};
use crate::budget::Budget;
use crate::counts::is_counts;
use crate::error::Error;
use crate::given::Given;
use crate::header;
use crate::mapping::{Mapping, ReadOptions};
use crate::place::{Counted, Lines};
use crate::report::Stretches;
use crate::table::Table;
use crate::time_unit;

/// Rows after which their mean length tells how many are to come.
const ROWS_TO_ESTIMATE: usize = 1000;
/// One row in so many may hold more values than there are names; more are another layout.
const FEW: usize = 10;

/// Reads columns and what is to be said of them.
pub(super) fn read(
    reader: impl Read,
    name: &str,
    bytes: Option<u64>,
    options: &ReadOptions,
) -> Result<Table, Error> {
    let mut lines = LineReader::new(reader, name)?;
    let (layout, mut seen) = layout::of_file(&mut lines)?;
    let settings = settings(&seen[..layout.header_at]);
    let header_line = seen.get(layout.header_at).map_or(0, |line| line.0);
    let utf_8 = seen.iter().all(|(_, line)| std::str::from_utf8(line).is_ok());
    let rows = seen.split_off(layout.rows_from.min(seen.len()));
    let (kinds, units) = kinds(&layout, &rows, &options.columns);
    lines.give_again(rows);
    let mut body = Body::new(&layout, kinds, &units, name, &options.columns);
    let mut fields = Fields::new(layout.delimiter);
    let mut budget = Budget::new(name);
    while let Some((line, content)) = lines.next()? {
        if content.first().is_some_and(|byte| !byte.is_ascii_digit()) && layout.is_comment(content)
        {
            continue;
        }
        fields.split(content);
        budget.take(body.columns.len())?;
        body.take(&fields, line);
        if body.count == ROWS_TO_ESTIMATE
            && let Some(bytes) = bytes
        {
            let total = (bytes as f64 / lines.bytes() as f64 * body.count as f64) as usize;
            // One in a hundred more than expected: later numbers may be written shorter.
            let more = (total + total / 100).saturating_sub(body.count);
            body.reserve(more.min(budget.left() / body.columns.len().max(1)));
        }
    }
    let mut notes = Vec::new();
    if layout.above > 0 {
        let above = layout.above;
        notes.push(format!("line {header_line} is the header; {above} lines above it are skipped"));
    }
    if !utf_8 {
        notes.push("the text is not UTF-8: read as Windows-1252".to_owned());
    }
    body.into_table(&settings, &units, options, notes)
}

/// The rows as they are taken.
struct Body<'a> {
    layout: &'a Layout,
    columns: Vec<Column>,
    lines: Lines,
    count: usize,
    /// The column of time, where its name tells.
    time: Option<usize>,
    /// The column of dates beside a clock.
    date: Option<usize>,
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
    repeats: usize,
}

impl<'a> Body<'a> {
    fn new(
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

    fn reserve(&mut self, more: usize) {
        self.columns.iter_mut().for_each(|column| column.reserve(more));
    }

    fn take(&mut self, fields: &Fields, line: u64) {
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

    fn into_table(
        mut self,
        settings: &[Setting],
        units: &[String],
        options: &ReadOptions,
        mut notes: Vec<String>,
    ) -> Result<Table, Error> {
        let mut left_out = Vec::new();
        self.leave_out_rows(&mut left_out, &mut notes)?;
        let Body { layout, columns, lines, count, date, repeats, .. } = self;
        let file = lines.file().to_owned();
        let has_time =
            layout.header.iter().any(|it| header::is_signal(it, "time", &options.columns));
        let mut clock_is_time = !has_time;
        let (mut header, mut kept) = (Vec::new(), Vec::new());
        for (k, (column, text)) in columns.into_iter().zip(&layout.header).enumerate() {
            let name = Given::of(text).name;
            let (kind, first) = (column.kind(), column.first_stamp());
            let values = match column.finish(&name, &lines) {
                Outcome::Values(values, mut more) => {
                    notes.append(&mut more);
                    values
                }
                Outcome::Empty => {
                    left_out.push(format!("column `{name}` is empty"));
                    continue;
                }
                Outcome::Text(example, line) => {
                    if options.columns.iter().any(|map| map.foreign == name) {
                        let place = lines.place_at(line);
                        let (position, column) = (k + 1, name);
                        return Err(Error::NotANumber { place, position, column, text: example });
                    }
                    left_out.push(format!("column `{name}` holds text, such as `{example}`"));
                    continue;
                }
            };
            match kind {
                Kind::Date if date == Some(k) => {
                    notes.push(format!("column `{name}` is the date of the clock beside it"));
                    continue;
                }
                Kind::Date => {
                    left_out.push(format!("column `{name}` holds dates without a time of day"));
                    continue;
                }
                Kind::Clock { .. } => {
                    notes
                        .push(format!("column `{name}` is a clock, read as s since its first row"));
                    let named = if std::mem::take(&mut clock_is_time) { "time" } else { &name };
                    header.push(format!("{named} [s]"));
                }
                Kind::Stamp => {
                    let unit = Given::of(text).unit.is_some();
                    let (unit, told) = time_unit::stamps(&name, unit, first, &values);
                    notes.push(told);
                    header.push(unit.map_or(text.clone(), |unit| format!("{name} [{unit}]")));
                }
                Kind::Number(_) if !units[k].is_empty() && Given::of(text).unit.is_none() => {
                    notes.push(format!("column `{name}` has its unit in every cell: {}", units[k]));
                    header.push(format!("{name} [{}]", units[k]));
                }
                Kind::Number(_) => header.push(with_counts(text, settings, &mut notes)),
            }
            kept.push(values);
        }
        if repeats > 0 {
            // Whether another run begins there, time tells.
            notes.push(format!("the header stands {} times", repeats + 1));
        }
        let has_time = has_time || !clock_is_time;
        let period_s = period_s(settings).filter(|_| !has_time);
        if let Some(period_s) = period_s {
            notes.push(format!(
                "no column is the time: sampled every {period_s} s, as told above the header"
            ));
        }
        if header.is_empty() && count > 0 {
            return Err(Error::NoSignals { file });
        }
        let columns = kept;
        Ok(Table { header, columns, left_out, notes, period_s, ..Table::new(lines) })
    }

    /// Says which lines are no rows, and takes an incomplete last row back.
    fn leave_out_rows(
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

/// The header of a column of counts with the counts a revolution that stand above it.
fn with_counts(text: &str, settings: &[Setting], notes: &mut Vec<String>) -> String {
    let Given { name, unit, .. } = Given::of(text);
    let unit = unit.filter(|unit| is_counts(unit));
    let (Some(unit), Some(counts)) = (unit, counts_a_revolution(settings)) else {
        return text.to_owned();
    };
    notes.push(format!("column `{name}`: {counts} {unit} a revolution, as told above the header"));
    format!("{name} [counts/{counts}]")
}
