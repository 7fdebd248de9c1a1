//! Tables of results as Parquet: columns of one length with units and descriptions, and what is said
//! of the whole in the file's metadata.
//!
//! ```text
//! metadata, Column ... -> Writer: one row group a call -> file -> Reader: group by group -> Column ...
//! ```
//!
//! A column's unit and description stand in the file's metadata as `unit.NAME` and
//! `description.NAME`, and as metadata of the field in the Arrow schema that readers of Arrow look
//! for.

mod arrow;
mod read;
mod write;

use parquet::errors::ParquetError;
use thiserror::Error;

pub use read::Reader;
pub use write::Writer;

/// Why a table cannot be read or written.
#[derive(Debug, Error)]
pub enum DatasetError {
    /// The file cannot be opened.
    #[error("cannot be read: {0}")]
    Open(#[from] std::io::Error),
    /// It is not Parquet, damaged or cut short.
    #[error("damaged or cut short ({0})")]
    Damaged(#[from] ParquetError),
    /// A column of another kind than it should have.
    #[error("column `{name}` is not of the kind that this program writes")]
    Kind {
        /// The column.
        name: String,
    },
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    pub name: String,
    /// Unit of its values; empty for words, counts and flags, `1` for fractions.
    pub unit: String,
    /// One line for a person.
    pub description: String,
    /// One value a row.
    pub values: Values,
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Whole numbers.
    Integers(Vec<i64>),
    /// Numbers; what is not a number is missing in the file.
    Numbers(Vec<f64>),
    /// Yes, no or missing.
    Flags(Vec<Option<bool>>),
    /// Words.
    Texts(Vec<String>),
}

impl Values {
    /// Rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Integers(values) => values.len(),
            Self::Numbers(values) => values.len(),
            Self::Flags(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The same kind without rows.
    #[must_use]
    pub fn emptied(&self) -> Self {
        match self {
            Self::Integers(_) => Self::Integers(Vec::new()),
            Self::Numbers(_) => Self::Numbers(Vec::new()),
            Self::Flags(_) => Self::Flags(Vec::new()),
            Self::Texts(_) => Self::Texts(Vec::new()),
        }
    }

    /// Takes the first rows away.
    #[must_use]
    pub fn split_front(&mut self, rows: usize) -> Self {
        fn front<T>(values: &mut Vec<T>, rows: usize) -> Vec<T> {
            let rest = values.split_off(rows.min(values.len()));
            std::mem::replace(values, rest)
        }
        match self {
            Self::Integers(values) => Self::Integers(front(values, rows)),
            Self::Numbers(values) => Self::Numbers(front(values, rows)),
            Self::Flags(values) => Self::Flags(front(values, rows)),
            Self::Texts(values) => Self::Texts(front(values, rows)),
        }
    }

    /// Adds rows of the same kind; false where it is another.
    pub fn append(&mut self, other: Self) -> bool {
        match (self, other) {
            (Self::Integers(values), Self::Integers(more)) => values.extend(more),
            (Self::Numbers(values), Self::Numbers(more)) => values.extend(more),
            (Self::Flags(values), Self::Flags(more)) => values.extend(more),
            (Self::Texts(values), Self::Texts(more)) => values.extend(more),
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<Column> {
        let column = |name: &str, unit: &str, values| Column {
            name: name.to_owned(),
            unit: unit.to_owned(),
            description: format!("what {name} is"),
            values,
        };
        vec![
            column("scenario", "", Values::Integers(vec![0, 1, 2])),
            column("delay", "s", Values::Numbers(vec![0.5, f64::NAN, 1.5])),
            column("detected", "", Values::Flags(vec![Some(true), None, Some(false)])),
            column("kind", "", Values::Texts(vec!["a".into(), "b".into(), "a".into()])),
        ]
    }

    fn equal(a: &Values, b: &Values) -> bool {
        match (a, b) {
            (Values::Numbers(a), Values::Numbers(b)) => {
                a.len() == b.len()
                    && a.iter()
                        .zip(b)
                        .all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
            }
            (a, b) => a == b,
        }
    }

    #[test]
    fn what_is_written_is_read_and_half_of_it_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.parquet");
        let said = vec![("plan".to_owned(), "digest".to_owned())];
        let columns = columns();
        let file = std::fs::File::create(&path).expect("a file");
        let mut writer = Writer::new(file, &columns, &said).expect("a header");
        writer.group(&columns).expect("rows");
        writer.group(&columns).expect("rows");
        writer.finish().expect("an end");
        let reader = Reader::open(&path).expect("it is whole");
        assert_eq!((reader.rows(), reader.groups()), (6, 2));
        assert_eq!(reader.said("plan"), Some("digest"));
        for group in 0..2 {
            let read = reader.group(group).expect("rows");
            for (read, written) in read.iter().zip(&columns) {
                assert_eq!((&read.name, &read.unit), (&written.name, &written.unit));
                assert_eq!(read.description, written.description);
                assert!(equal(&read.values, &written.values), "{}", read.name);
            }
        }
        let bytes = std::fs::read(&path).expect("it is there");
        for length in [0, 4, bytes.len() / 2, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..length]).expect("it can be written");
            assert!(Reader::open(&path).is_err(), "{length} of {}", bytes.len());
        }
    }
}
