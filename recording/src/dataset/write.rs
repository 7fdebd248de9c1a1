//! Writes a table group by group.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type};

use super::{Column, DatasetError, Values, arrow};

/// A table that is being written.
pub struct Writer<W: Write + Send>(SerializedFileWriter<W>);

impl<W: Write + Send> Writer<W> {
    /// Begins a table with those columns (their values are not looked at) and what is said of it.
    ///
    /// # Errors
    /// It cannot be written to.
    pub fn new(
        out: W,
        columns: &[Column],
        said: &[(String, String)],
    ) -> Result<Self, DatasetError> {
        let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
        let schema = Arc::new(Type::group_type_builder("scenarios").with_fields(fields).build()?);
        let mut pairs: Vec<KeyValue> =
            said.iter().map(|(key, value)| KeyValue::new(key.clone(), value.clone())).collect();
        for Column { name, unit, description, .. } in columns {
            pairs.push(KeyValue::new(format!("unit.{name}"), unit.clone()));
            pairs.push(KeyValue::new(format!("description.{name}"), description.clone()));
        }
        pairs.push(KeyValue::new("ARROW:schema".to_owned(), arrow::schema(columns)));
        let mut properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            // A dictionary only pays where values repeat.
            .set_dictionary_enabled(false)
            .set_key_value_metadata(Some(pairs));
        for column in columns.iter().filter(|it| matches!(it.values, Values::Texts(_))) {
            let path = ColumnPath::new(vec![column.name.clone()]);
            properties = properties.set_column_dictionary_enabled(path, true);
        }
        Ok(Self(SerializedFileWriter::new(out, schema, Arc::new(properties.build()))?))
    }

    /// Writes rows, a value of each column.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn group(&mut self, columns: &[Column]) -> Result<(), DatasetError> {
        let mut group = self.0.next_row_group()?;
        for Column { values, .. } in columns {
            let Some(mut column) = group.next_column()? else {
                return Err(ParquetError::General("more columns than before".to_owned()).into());
            };
            match values {
                Values::Integers(values) => {
                    column.typed::<Int64Type>().write_batch(values, None, None)?;
                }
                Values::Numbers(values) => {
                    let levels: Vec<i16> =
                        values.iter().map(|it| i16::from(!it.is_nan())).collect();
                    let present: Vec<f64> =
                        values.iter().copied().filter(|it| !it.is_nan()).collect();
                    column.typed::<DoubleType>().write_batch(&present, Some(&levels), None)?;
                }
                Values::Flags(values) => {
                    let levels: Vec<i16> =
                        values.iter().map(|it| i16::from(it.is_some())).collect();
                    let present: Vec<bool> = values.iter().copied().flatten().collect();
                    column.typed::<BoolType>().write_batch(&present, Some(&levels), None)?;
                }
                Values::Texts(values) => {
                    let bytes: Vec<ByteArray> =
                        values.iter().map(|it| ByteArray::from(it.as_str())).collect();
                    column.typed::<ByteArrayType>().write_batch(&bytes, None, None)?;
                }
            }
            column.close()?;
        }
        group.close()?;
        Ok(())
    }

    /// Ends the table.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(self) -> Result<(), DatasetError> {
        self.0.close()?;
        Ok(())
    }
}

fn field(column: &Column) -> Result<Arc<Type>, ParquetError> {
    let (physical, repetition) = match column.values {
        Values::Integers(_) => (Physical::INT64, Repetition::REQUIRED),
        Values::Numbers(_) => (Physical::DOUBLE, Repetition::OPTIONAL),
        Values::Flags(_) => (Physical::BOOLEAN, Repetition::OPTIONAL),
        Values::Texts(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED),
    };
    let field = Type::primitive_type_builder(&column.name, physical).with_repetition(repetition);
    let field = match column.values {
        Values::Texts(_) => field.with_logical_type(Some(LogicalType::String)),
        _ => field,
    };
    field.build().map(Arc::new)
}
