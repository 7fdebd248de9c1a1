//! Reads a table group by group.

use std::fs::File;
use std::path::Path;

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::{Column, DatasetError, Values};

/// A table that is whole: its end was read.
pub struct Reader(SerializedFileReader<File>);

impl Reader {
    /// Opens a table.
    ///
    /// # Errors
    /// It is not there, no Parquet file, or cut short.
    pub fn open(path: &Path) -> Result<Self, DatasetError> {
        Ok(Self(SerializedFileReader::new(File::open(path)?)?))
    }

    /// Its rows.
    pub fn rows(&self) -> usize {
        usize::try_from(self.0.metadata().file_metadata().num_rows()).unwrap_or(0)
    }

    /// Its groups of rows.
    pub fn groups(&self) -> usize {
        self.0.num_row_groups()
    }

    /// What is said of it under a key.
    pub fn said(&self, key: &str) -> Option<&str> {
        let pairs = self.0.metadata().file_metadata().key_value_metadata()?;
        pairs.iter().find(|pair| pair.key == key)?.value.as_deref()
    }

    /// Its columns with the rows of a group.
    ///
    /// # Errors
    /// The group is damaged, or a column is of a kind that is not written here.
    pub fn group(&self, group: usize) -> Result<Vec<Column>, DatasetError> {
        let schema = self.0.metadata().file_metadata().schema_descr_ptr();
        let rows = self.0.get_row_group(group)?;
        let count = usize::try_from(rows.metadata().num_rows()).unwrap_or(0);
        let mut columns = Vec::with_capacity(schema.num_columns());
        for (k, column) in schema.columns().iter().enumerate() {
            let name = column.name().to_owned();
            let wanted = rows.get_column_reader(k)?;
            let values = match wanted {
                ColumnReader::Int64ColumnReader(reader) => {
                    Values::Integers(required(reader, count)?)
                }
                ColumnReader::DoubleColumnReader(reader) => {
                    let missing = |value: Option<f64>| value.unwrap_or(f64::NAN);
                    Values::Numbers(optional(reader, count)?.into_iter().map(missing).collect())
                }
                ColumnReader::BoolColumnReader(reader) => Values::Flags(optional(reader, count)?),
                ColumnReader::ByteArrayColumnReader(reader) => {
                    let bytes = required(reader, count)?;
                    let text = |bytes: &parquet::data_type::ByteArray| {
                        String::from_utf8_lossy(bytes.data()).into_owned()
                    };
                    Values::Texts(bytes.iter().map(text).collect())
                }
                _ => return Err(DatasetError::Kind { name }),
            };
            let said = |what: &str| self.said(&format!("{what}.{name}")).unwrap_or("").to_owned();
            let (unit, description) = (said("unit"), said("description"));
            columns.push(Column { name, unit, description, values });
        }
        Ok(columns)
    }
}

fn required<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    count: usize,
) -> Result<Vec<T::T>, ParquetError> {
    let mut values = Vec::new();
    while values.len() < count {
        let (records, _, _) = reader.read_records(count - values.len(), None, None, &mut values)?;
        if records == 0 {
            return Err(ParquetError::EOF("a column ends early".to_owned()));
        }
    }
    Ok(values)
}

fn optional<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    count: usize,
) -> Result<Vec<Option<T::T>>, ParquetError> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    while levels.len() < count {
        let wanted = count - levels.len();
        let (records, _, _) = reader.read_records(wanted, Some(&mut levels), None, &mut values)?;
        if records == 0 {
            return Err(ParquetError::EOF("a column ends early".to_owned()));
        }
    }
    let mut present = values.into_iter();
    Ok(levels.iter().map(|level| if *level > 0 { present.next() } else { None }).collect())
}
