//! The TOML text of a drive file with the place of every key and value.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::error::{DriveFileError, Flaw, Location, Problem};

/// A parsed text.
pub(super) struct Document<'a> {
    pub(super) text: &'a str,
    pub(super) root: DeTable<'a>,
}

/// Bytes of a key and of its value.
#[derive(Debug, Clone)]
pub(super) struct Spans {
    pub(super) key: Range<usize>,
    pub(super) value: Range<usize>,
}

impl<'a> Document<'a> {
    /// Parses TOML.
    pub(super) fn parse(text: &'a str) -> Result<Self, Flaw> {
        let root = DeTable::parse(text).map_err(|error| {
            Flaw::new(
                Problem::Syntax { reason: error.message().replace('\n', ", ") },
                error.span().unwrap_or(0..0),
            )
        })?;
        Ok(Self { text, root: root.into_inner() })
    }

    /// Where a key of the table stands.
    pub(super) fn spans(table: &DeTable<'_>, key: &str) -> Option<Spans> {
        let (key, value) = table.get_key_value(key)?;
        Some(Spans { key: key.span(), value: value.span() })
    }

    /// A table of the file by its name.
    pub(super) fn section(&self, name: &str) -> Option<&DeTable<'a>> {
        self.root.get(name)?.get_ref().as_table()
    }

    /// An effect by its number, with its place.
    pub(super) fn effect(&self, number: usize) -> Option<(&DeTable<'a>, Range<usize>)> {
        let effect = self.root.get("effect")?.get_ref().get(number)?;
        Some((effect.get_ref().as_table()?, effect.span()))
    }

    /// Where `[section] key` stands; what encloses it where it is absent.
    pub(super) fn place_of(&self, section: &str, key: &str) -> Spans {
        let table = self.section(section);
        table
            .and_then(|table| Self::spans(table, key))
            .or_else(|| Self::spans(&self.root, section))
            .unwrap_or(Spans { key: 0..0, value: 0..0 })
    }

    /// Where the `number`-th text of the list `[section] key` stands.
    pub(super) fn item(&self, section: &str, key: &str, number: usize) -> Range<usize> {
        let list = self.section(section).and_then(|table| table.get(key));
        let item = list.and_then(|list| list.get_ref().get(number)).map(|item| item.span());
        item.unwrap_or_else(|| self.place_of(section, key).value)
    }

    /// Line of a byte, from 1.
    pub(super) fn line(&self, at: usize) -> usize {
        line(self.text, at)
    }
}

fn line(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count()
}

impl Flaw {
    /// The error, with the place in lines and columns.
    pub(super) fn within(self, file: &str, text: &str) -> DriveFileError {
        let before = text.get(..self.span.start).unwrap_or(text);
        let start_of_line = before.rfind('\n').map_or(0, |newline| newline + 1);
        DriveFileError::Content {
            place: Location {
                file: file.to_owned(),
                line: line(text, self.span.start),
                column: 1 + before[start_of_line..].chars().count(),
                span: self.span,
            },
            problem: self.problem,
        }
    }
}

/// The value as the file has it, shortened to one line.
pub(super) fn shown(text: &str, value: &DeValue<'_>, span: Range<usize>) -> String {
    match value {
        DeValue::Table(_) => "a table".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        _ => {
            let source = text.get(span).unwrap_or_default();
            source.lines().next().unwrap_or_default().chars().take(60).collect()
        }
    }
}
