//! Recordings as Parquet: one column of doubles a signal, `name [unit]` as in CSV.
//!
//! The units stand in the file's metadata, too (`unit.omega` = `rad/s`). Integers, floats, flags
//! and time stamps are read; texts, decimals and nested columns are left out and named.

use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnDescriptor, Type};

use super::Format;
use crate::budget::Budget;
use crate::error::Error;
use crate::mapping::ReadOptions;
use crate::place::Lines;
use crate::signal::{Recording, Signal};
use crate::table::Table;

/// Values that are unpacked at a time.
const BATCH: usize = 1 << 14;
/// Rows that are written as one group.
const GROUP: usize = 1 << 20;

pub(super) static FORMAT: Format = Format {
    name: "Parquet",
    extensions: &["parquet", "pq"],
    starts: |head| head.starts_with(b"PAR1"),
    read: table,
    write: Some(|out, recording| write(out, recording)),
};

/// Unpacks column by column.
fn table(opened: File, file: &str, _: &ReadOptions) -> Result<Table, Error> {
    let damaged = |what: String| {
        let (file, format) = (file.to_owned(), FORMAT.name);
        Error::Damaged { file, format, what }
    };
    let failed = |source: ParquetError| damaged(source.to_string());
    let reader = SerializedFileReader::new(opened).map_err(failed)?;
    let metadata = reader.metadata();
    let rows = usize::try_from(metadata.file_metadata().num_rows()).unwrap_or(usize::MAX);
    let mut budget = Budget::new(file);
    for chunk in metadata.row_groups().iter().flat_map(|group| group.columns()) {
        // A chunk is unpacked page by page; no page can be larger than its chunk.
        let unpacked = u64::try_from(chunk.uncompressed_size()).unwrap_or(u64::MAX);
        Budget::new(file).take_bytes(unpacked)?;
        let compression = chunk.compression();
        if !matches!(
            compression,
            Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::GZIP(_)
        ) {
            return Err(Error::Variety {
                file: file.to_owned(),
                what: format!("packed with {compression}"),
                instead: "write it with compression=\"snappy\"",
            });
        }
    }
    let schema = metadata.file_metadata().schema_descr_ptr();
    let (mut header, mut columns, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for (k, column) in schema.columns().iter().enumerate() {
        let name = column.path().parts().join(".");
        let Some(kind) = Kind::of(column) else {
            left_out.push(format!("column `{name}` is not a plain series of numbers"));
            continue;
        };
        let mut values = Values { kind, first: None, most: rows, list: Vec::new() };
        budget.take(rows)?;
        // A damaged count must not cost memory; without a reservation the list grows as it fills.
        let _ = values.list.try_reserve_exact(rows);
        for group in 0..metadata.num_row_groups() {
            let group = reader.get_row_group(group).map_err(failed)?;
            let column = group.get_column_reader(k).map_err(failed)?;
            values.append(column, schema.column(k).max_def_level()).map_err(failed)?;
        }
        header.push(if kind.in_seconds() { format!("{name} [s]") } else { name });
        columns.push(values.list);
    }
    if columns.is_empty() {
        return Err(Error::NoSignals { file: file.to_owned() });
    }
    let length = columns.first().map_or(0, Vec::len);
    if columns.iter().any(|column| column.len() != length) {
        return Err(damaged("its columns differ in length".to_owned()));
    }
    Ok(Table { header, columns, left_out, ..Table::new(Lines::rows(file)) })
}

/// What the numbers of a column mean.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Plain,
    /// Integer time stamps, so many to a second; read as seconds since the first, because a date
    /// in seconds leaves no digits for milliseconds.
    Stamps(f64),
}

impl Kind {
    fn of(column: &ColumnDescriptor) -> Option<Kind> {
        let numeric = matches!(
            column.physical_type(),
            Physical::BOOLEAN
                | Physical::INT32
                | Physical::INT64
                | Physical::FLOAT
                | Physical::DOUBLE
        );
        if !numeric || column.max_rep_level() > 0 || column.path().parts().len() > 1 {
            return None;
        }
        let to_a_second = |unit: &TimeUnit| match unit {
            TimeUnit::MILLIS => 1e3,
            TimeUnit::MICROS => 1e6,
            TimeUnit::NANOS => 1e9,
        };
        match column.logical_type_ref() {
            None | Some(LogicalType::Integer(_)) => Some(Kind::Plain),
            Some(LogicalType::Timestamp(it)) => Some(Kind::Stamps(to_a_second(&it.unit))),
            Some(LogicalType::Time(it)) => Some(Kind::Stamps(to_a_second(&it.unit))),
            Some(_) => None,
        }
    }

    fn in_seconds(self) -> bool {
        matches!(self, Kind::Stamps(_))
    }
}

/// A column's values so far.
struct Values {
    kind: Kind,
    first: Option<i64>,
    /// Rows that the file says it has.
    most: usize,
    list: Vec<f64>,
}

impl Values {
    /// Adds a row group's values; a missing one becomes NaN.
    fn append(&mut self, column: ColumnReader, level: i16) -> Result<(), ParquetError> {
        let list = &mut Limited { most: self.most, list: &mut self.list };
        match column {
            ColumnReader::BoolColumnReader(reader) => {
                each(reader, level, list, |value| f64::from(u8::from(*value)))
            }
            ColumnReader::FloatColumnReader(reader) => each(reader, level, list, |it| (*it).into()),
            ColumnReader::DoubleColumnReader(reader) => each(reader, level, list, |it| *it),
            ColumnReader::Int32ColumnReader(reader) => {
                let (kind, first) = (self.kind, &mut self.first);
                each(reader, level, list, |it| integer(kind, first, i64::from(*it)))
            }
            ColumnReader::Int64ColumnReader(reader) => {
                let (kind, first) = (self.kind, &mut self.first);
                each(reader, level, list, |it| integer(kind, first, *it))
            }
            // Left out by `Kind::of`: their values are no numbers.
            ColumnReader::Int96ColumnReader(_)
            | ColumnReader::ByteArrayColumnReader(_)
            | ColumnReader::FixedLenByteArrayColumnReader(_) => Ok(()),
        }
    }
}

/// A list that ends where the file's rows do, whatever its pages say.
struct Limited<'a> {
    most: usize,
    list: &'a mut Vec<f64>,
}

fn integer(kind: Kind, first: &mut Option<i64>, value: i64) -> f64 {
    match kind {
        Kind::Plain => value as f64,
        Kind::Stamps(to_a_second) => {
            let since = i128::from(value) - i128::from(*first.get_or_insert(value));
            since as f64 / to_a_second
        }
    }
}

fn each<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    level: i16,
    limited: &mut Limited<'_>,
    mut number: impl FnMut(&T::T) -> f64,
) -> Result<(), ParquetError> {
    let (mut values, mut levels) = (Vec::with_capacity(BATCH), Vec::new());
    let Limited { most, list } = limited;
    loop {
        values.clear();
        levels.clear();
        let wanted = (level > 0).then_some(&mut levels);
        let (records, _, _) = reader.read_records(BATCH, wanted, None, &mut values)?;
        if records == 0 {
            return Ok(());
        }
        if list.len() + records > *most {
            return Err(ParquetError::General("a column has more rows than the file".to_owned()));
        }
        if level == 0 {
            list.extend(values.iter().map(&mut number));
        } else {
            let mut present = values.iter().map(&mut number);
            let value = |found: &i16| if *found == level { present.next() } else { None };
            list.extend(levels.iter().map(value).map(|it| it.unwrap_or(f64::NAN)));
        }
    }
}

/// Writes a recording as Parquet, its time first.
fn write(out: &mut (impl Write + Send), recording: &Recording) -> io::Result<()> {
    written(out, recording).map_err(io::Error::other)
}

fn written(out: &mut (impl Write + Send), recording: &Recording) -> Result<(), ParquetError> {
    let segment = recording.segment_column();
    let signals: Vec<&Signal> = recording.signals.iter().chain(&segment).collect();
    let names = std::iter::once("time [s]".to_owned()).chain(signals.iter().map(|it| it.header()));
    let fields = names.map(|name| {
        let column = Type::primitive_type_builder(&name, Physical::DOUBLE);
        column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    });
    let fields = fields.collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("recording").with_fields(fields).build()?);
    let units = std::iter::once(("time", "s"))
        .chain(signals.iter().map(|it| (it.name.as_str(), it.unit.as_str())))
        .map(|(name, unit)| KeyValue::new(format!("unit.{name}"), unit.to_owned()));
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        // A dictionary only pays where numbers repeat.
        .set_dictionary_enabled(false)
        .set_key_value_metadata(Some(units.collect()))
        .build();
    let mut writer = SerializedFileWriter::new(out, schema, Arc::new(properties))?;
    for from in (0..recording.len()).step_by(GROUP) {
        let rows = from..(from + GROUP).min(recording.len());
        let time: Vec<f64> = rows.clone().map(|k| recording.time(k)).collect();
        let parts = signals.iter().map(|it| &it.values[rows.clone()]);
        let mut group = writer.next_row_group()?;
        for values in std::iter::once(&time[..]).chain(parts) {
            if let Some(mut column) = group.next_column()? {
                column.typed::<DoubleType>().write_batch(values, None, None)?;
                column.close()?;
            }
        }
        group.close()?;
    }
    writer.close()?;
    Ok(())
}
