//! Rows and columns.

use super::{ALL, Key, Media, Tone};

/// What a column says of what a row stands for.
pub(crate) type Said<T> = fn(&T) -> Cell;

/// Rows and columns.
#[derive(Debug)]
pub(crate) struct Table {
    /// What it shows.
    pub(crate) caption: String,
    /// The columns; the first one names the rows.
    pub(crate) columns: Vec<Column>,
    /// The rows, with a cell for every column.
    pub(crate) rows: Vec<Row>,
    /// Rows, from 0, with which another kind of them begins.
    pub(crate) parts: Vec<usize>,
}

impl Table {
    /// Without rows as yet.
    pub(crate) fn new(caption: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { caption: caption.into(), columns, rows: Vec::new(), parts: Vec::new() }
    }

    /// A row for each of those things. A column stands beside what its cells say, so that no cell can
    /// get under another's heading.
    pub(crate) fn of<T>(
        caption: impl Into<String>,
        columns: &[(Column, Said<T>)],
        rows: impl IntoIterator<Item = T>,
    ) -> Self {
        let mut table =
            Self::new(caption, columns.iter().map(|(column, _)| column.clone()).collect());
        for row in rows {
            table.push(columns.iter().map(|(_, said)| said(&row)).collect());
        }
        table
    }

    /// With a row more.
    pub(crate) fn push(&mut self, cells: Vec<Cell>) {
        self.rows.push(Row { key: None, cells });
    }

    /// Another kind of rows begins.
    pub(crate) fn part(&mut self) {
        self.parts.push(self.rows.len());
    }
}

/// How the cells of a column stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    /// Numbers, flush right.
    Number,
    /// Names, flush left.
    Name,
    /// Symbols of the equations, typeset where they can be.
    Symbol,
    /// Sentences, which may break.
    Words,
}

/// A column.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    /// What stands above it, with the unit.
    pub(crate) heading: String,
    /// What it and its neighbours share; empty if they share nothing. A text, which is narrow, has a
    /// table for each of these.
    pub(crate) group: String,
    /// How its cells stand.
    pub(crate) align: Align,
    /// Whether it is there to compare others with.
    pub(crate) beside: bool,
    /// Where it is shown.
    pub(crate) media: Media,
}

impl Column {
    pub(crate) fn new(align: Align, heading: impl Into<String>) -> Self {
        let (heading, group) = (heading.into(), String::new());
        Self { heading, group, align, beside: false, media: ALL }
    }

    pub(crate) fn only(self, media: Media) -> Self {
        Self { media, ..self }
    }

    pub(crate) fn under(self, group: impl Into<String>) -> Self {
        Self { group: group.into(), ..self }
    }

    pub(crate) fn beside(self) -> Self {
        Self { beside: true, ..self }
    }
}

/// A row.
#[derive(Debug)]
pub(crate) struct Row {
    /// What it stands for.
    pub(crate) key: Option<Key>,
    pub(crate) cells: Vec<Cell>,
}

/// A cell.
#[derive(Debug)]
pub(crate) struct Cell {
    /// What it says.
    pub(crate) text: String,
    /// What it stands for.
    pub(crate) key: Option<Key>,
    /// What it means.
    pub(crate) tone: Tone,
}

impl Cell {
    /// With what it stands for.
    pub(crate) fn of(text: impl Into<String>, key: Option<Key>) -> Self {
        Self { text: text.into(), key, tone: Tone::Plain }
    }

    /// With what it means, if it is so.
    pub(crate) fn toned(self, tone: Tone, is: bool) -> Self {
        Self { tone: if is { tone } else { self.tone }, ..self }
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self::of(text, None)
    }
}
