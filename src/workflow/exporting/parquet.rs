//! Parquet files with one table: one row group, cells compressed with Snappy, which every reader supports.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

/// The cells of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParquetCells<'a> {
    /// Double precision; null where a number is NaN.
    F64(&'a [f64]),
    /// Single precision; NaN stays NaN.
    F32(&'a [f32]),
    /// Unsigned 32 bits.
    U32(&'a [u32]),
    /// Unsigned 8 bits.
    U8(&'a [u8]),
    /// Text.
    Texts(&'a [String]),
}

/// The bytes of a file with columns of equal length, and `about` as key-value metadata.
///
/// # Errors
/// If columns have different lengths or the same name.
pub fn parquet_file(
    columns: &[(&str, ParquetCells<'_>)],
    about: &[(&str, &str)],
) -> Result<Vec<u8>> {
    let fields = columns
        .iter()
        .map(|(name, cells)| Ok(Arc::new(cells.field(name)?)));
    let fields = fields.collect::<Result<Vec<_>>>()?;
    let schema = Type::group_type_builder("table")
        .with_fields(fields)
        .build()?;
    let about = about
        .iter()
        .map(|(key, text)| KeyValue::new((*key).to_owned(), (*text).to_owned()));
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(about.collect()))
        .build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, cells) in columns {
        cells.write(&mut group)?;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

impl ParquetCells<'_> {
    fn field(&self, name: &str) -> Result<Type> {
        let (physical, repetition, logical) = match self {
            Self::F64(_) => (Physical::DOUBLE, Repetition::OPTIONAL, None),
            Self::F32(_) => (Physical::FLOAT, Repetition::REQUIRED, None),
            Self::U32(_) => (
                Physical::INT32,
                Repetition::REQUIRED,
                Some(LogicalType::integer(32, false)),
            ),
            Self::U8(_) => (
                Physical::INT32,
                Repetition::REQUIRED,
                Some(LogicalType::integer(8, false)),
            ),
            Self::Texts(_) => (
                Physical::BYTE_ARRAY,
                Repetition::REQUIRED,
                Some(LogicalType::String),
            ),
        };
        Type::primitive_type_builder(name, physical)
            .with_repetition(repetition)
            .with_logical_type(logical)
            .build()
    }

    fn write(&self, group: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>) -> Result<()> {
        match self {
            Self::F64(numbers) => {
                let present: Vec<f64> = numbers
                    .iter()
                    .copied()
                    .filter(|one| !one.is_nan())
                    .collect();
                let levels: Vec<i16> = numbers.iter().map(|one| i16::from(!one.is_nan())).collect();
                put::<DoubleType>(group, &present, Some(&levels))
            }
            Self::F32(numbers) => put::<FloatType>(group, numbers, None),
            // The sign is that of the logical type.
            Self::U32(numbers) => {
                let numbers: Vec<i32> = numbers.iter().map(|one| one.cast_signed()).collect();
                put::<Int32Type>(group, &numbers, None)
            }
            Self::U8(numbers) => {
                let numbers: Vec<i32> = numbers.iter().map(|one| i32::from(*one)).collect();
                put::<Int32Type>(group, &numbers, None)
            }
            Self::Texts(texts) => {
                let texts: Vec<ByteArray> = texts.iter().map(|text| text.as_str().into()).collect();
                put::<ByteArrayType>(group, &texts, None)
            }
        }
    }
}

fn put<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<()> {
    let column = group.next_column()?;
    let mut column = column.ok_or_else(|| ParquetError::General("a column too many".to_owned()))?;
    column.typed::<T>().write_batch(values, levels, None)?;
    column.close()
}
