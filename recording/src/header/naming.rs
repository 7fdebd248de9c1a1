//! The columns of a file while they get their names: the user's word, a signal's own name, a guess.

use super::column::{Column, Taken, place};
use super::left_out::LeftOut;
use super::which::{find, listed};
use super::{Header, NAMELESS};
use crate::canonical::{self, Canonical};
use crate::error::Error;
use crate::given::Given;
use crate::look::Look;
use crate::mapping::Mapping;

/// The headers, the columns that have their names already, and what those are.
pub(super) struct Naming<'a> {
    pub(super) file: &'a str,
    pub(super) given: Vec<Given>,
    /// What the values show, where they are known.
    pub(super) looks: &'a [Look],
    pub(super) columns: Vec<Option<Column>>,
    /// Names that are taken.
    pub(super) used: Vec<&'a str>,
    /// What could not be told, a sentence each.
    pub(super) notes: Vec<String>,
    /// Columns that are left out, and what is said of them.
    pub(super) left_out: LeftOut,
}

impl<'a> Naming<'a> {
    /// With the names that the user gave.
    pub(super) fn mapped(
        file: &'a str,
        given: Vec<Given>,
        maps: &'a [Mapping],
        looks: &'a [Look],
    ) -> Result<Self, Error> {
        let mut columns: Vec<Option<Column>> = vec![None; given.len()];
        for map in maps {
            let position = find(&given, &map.foreign).ok_or_else(|| Error::MappedColumn {
                file: file.to_owned(),
                column: map.foreign.clone(),
                signal: map.canonical.clone(),
                columns: listed(&given),
            })?;
            let unit = map.unit.as_ref().or(given[position].unit.as_ref());
            let known = canonical::exact(&map.canonical);
            let column = place(file, &given[position], &map.canonical, known, unit, Taken::Mapped)?;
            columns[position] = Some(column);
        }
        let used = maps.iter().map(|map| map.canonical.as_str()).collect();
        let left_out = LeftOut::default();
        Ok(Self { file, given, looks, columns, used, notes: Vec::new(), left_out })
    }

    /// Positions of the columns that have no name yet.
    pub(super) fn open(&self) -> Vec<usize> {
        let is_open = |k: &usize| self.columns[*k].is_none() && !self.left_out.columns.contains(k);
        (0..self.given.len()).filter(is_open).collect()
    }

    /// Gives the column at `k` a name.
    pub(super) fn name(
        &mut self,
        k: usize,
        signal: &str,
        known: Option<&Canonical>,
        unit: Option<&String>,
        taken: Taken,
    ) -> Result<(), Error> {
        self.columns[k] = Some(place(self.file, &self.given[k], signal, known, unit, taken)?);
        Ok(())
    }

    /// Refuses two columns of one header.
    pub(super) fn no_column_twice(&self) -> Result<(), Error> {
        for second in self.open() {
            let column = &self.given[second];
            let same = |k: &usize| *k < second && self.given[*k].name == column.name;
            if let Some(first) = self.open().into_iter().find(same) {
                let (file, name) = (self.file.to_owned(), column.name.clone());
                let (first, second, unused) = (first + 1, second + 1, self.all_unused(second));
                return Err(Error::DuplicateColumn { file, name, first, second, unused });
            }
        }
        Ok(())
    }

    /// The mappings by which this column and those behind it that are called alike are not used.
    fn all_unused(&self, from: usize) -> String {
        let name = &self.given[from].name;
        let alike = |k: &usize| self.given[*k].name == *name;
        let number = |k: usize| 1 + (0..k).filter(alike).count();
        let twins = self.open().into_iter().filter(|k| *k >= from && alike(k)).map(number);
        let each = twins.map(|number| match number {
            2 => format!("{name}_unused={name}#2"),
            _ => format!("{name}_unused_{number}={name}#{number}"),
        });
        each.collect::<Vec<_>>().join(",")
    }

    /// Where nothing else is the time: the first column that runs like a clock.
    pub(super) fn take_clock(&mut self) -> Result<(), Error> {
        if self.used.contains(&"time") {
            return Ok(());
        }
        let nameless = self.given.iter().all(|column| column.name.starts_with(NAMELESS));
        let runs = |k: &usize| self.looks.get(*k).is_some_and(|look| look.like_clock);
        let Some(k) = self.open().into_iter().find(runs).filter(|k| *k == 0 || nameless) else {
            return Ok(());
        };
        let known = canonical::exact("time");
        let unit = self.given[k].unit.clone();
        let unit = unit.filter(|unit| known.is_some_and(|known| known.accepts(unit)));
        self.name(k, "time", known, unit.as_ref(), Taken::Guessed)?;
        let name = &self.given[k].name;
        self.notes.push(format!("column `{name}` runs like a clock: taken as the time"));
        Ok(())
    }

    /// What is left keeps its own name.
    pub(super) fn finish(mut self) -> Result<Header, Error> {
        for k in self.open() {
            let Given { name, unit, .. } = self.given[k].clone();
            self.name(k, &name, None, unit.as_ref(), Taken::Kept)?;
        }
        let columns: Vec<Column> = self.columns.into_iter().flatten().collect();
        no_name_twice(self.file, &columns)?;
        let time = columns.iter().position(|column| column.note.signal == "time");
        Ok(Header { columns, time, notes: self.notes, left_out: self.left_out })
    }
}

fn no_name_twice(file: &str, columns: &[Column]) -> Result<(), Error> {
    for (k, column) in columns.iter().enumerate() {
        let name = &column.note.signal;
        if let Some(other) = columns[..k].iter().find(|other| other.note.signal == *name) {
            return Err(Error::DuplicateSignal {
                file: file.to_owned(),
                name: name.clone(),
                first: other.note.column.clone(),
                second: column.note.column.clone(),
            });
        }
    }
    Ok(())
}

/// What to say of a column of counts that would be that signal.
pub(super) fn uncounted(column: &str, signal: &str) -> String {
    let unit = if matches!(signal, "x" | "x_load") { "counts*0.05um" } else { "counts/4096" };
    format!(
        "column `{column}` is kept in counts: say how many make a revolution (or how long one is) \
         with --columns {signal}={column}:{unit}"
    )
}
