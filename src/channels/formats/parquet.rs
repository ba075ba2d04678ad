//! Parquet tables, read column by column and one group of rows after the other.

use std::fs::File;

use parquet::basic::{Compression, ConvertedType, LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{AsBytes, ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;
use tautline_files::{Location, ReadError, quoted, read_damaged};

use super::{HAS_MORE_FORMATS, LEFT_OUT, over_budget, stem};
use crate::input::Input;
use crate::memory::{MemoryBudget, OverBudget};
use crate::source::{Filling, FillingTexts, Format, Series, Source};
use crate::units::split_heading;

/// Rows that are decoded at a time.
const ROWS: usize = 1 << 13;
/// Bytes of a value of a channel, and at least of a text.
const VALUE: usize = size_of::<f64>();

/// A column of the file with its destination.
struct ColumnBuilder {
    /// Index of the column in the file.
    number: usize,
    /// Definition level of a cell that has a value.
    level: i16,
    name: String,
    unit: Option<String>,
    scale: Scale,
    cells: Filling,
}

pub(super) fn read(input: &mut Input<'_>, file: &str) -> Result<Source, ReadError> {
    read_damaged(|| read_table(input, file)).unwrap_or_else(|| {
        let message = "is damaged, expected Parquet";
        Err(ReadError::new(file, Location::File, message))
    })
}

/// Fails if cells are compressed by a method that this build cannot decompress.
fn check_compressor(compression: Compression) -> Result<(), String> {
    let name = match compression {
        Compression::UNCOMPRESSED | Compression::SNAPPY => return Ok(()),
        Compression::GZIP(_) => "gzip",
        Compression::LZ4 | Compression::LZ4_RAW => "LZ4",
        Compression::ZSTD(_) => "Zstandard",
        Compression::BROTLI(_) | Compression::LZO => {
            let expected = "Snappy, gzip, LZ4 or Zstandard";
            return Err(format!(
                "is compressed with {compression}, expected {expected}"
            ));
        }
    };
    if HAS_MORE_FORMATS {
        return Ok(());
    }
    Err(format!("is compressed with {name}, {LEFT_OUT}, or Snappy"))
}

fn read_table(input: &mut Input<'_>, file: &str) -> Result<Source, ReadError> {
    let damaged = |error: ParquetError| {
        let message = match error {
            ParquetError::NYI(what) => format!("uses an unsupported feature ({what})"),
            ParquetError::External(error) if error.is::<OverBudget>() => error.to_string(),
            error => format!("is damaged, expected Parquet ({error})"),
        };
        ReadError::new(file, Location::File, message)
    };
    let io = |error: std::io::Error| ReadError::io(file, Location::File, &error);
    let over = |over| over_budget(file, over);
    let reader = SerializedFileReader::new(input.file().map_err(io)?).map_err(damaged)?;
    let mut notices = Vec::new();
    let mut columns = columns(&reader, file, &mut notices);
    let mut rows = 0;
    for number in 0..reader.num_row_groups() {
        let group = reader.get_row_group(number).map_err(damaged)?;
        let count = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        for column in &mut columns {
            let chunk = group.metadata().column(column.number);
            check_compressor(chunk.compression())
                .map_err(|message| ReadError::new(file, Location::File, message))?;
            // Pages are decompressed as a whole.
            let content = u64::try_from(chunk.uncompressed_size()).unwrap_or(u64::MAX);
            input.budget().temporary().take(content).map_err(over)?;
            let cells = group.get_column_reader(column.number).map_err(damaged)?;
            let read = column.fill(cells, input.budget()).map_err(damaged)?;
            if read != count {
                let name = quoted(&column.name);
                let (found, expected) = (rows + read, rows + count);
                let message = format!("column {name} ends after {found} rows, expected {expected}");
                return Err(ReadError::new(file, Location::File, message));
            }
            let bytes = chunk.compressed_size();
            input
                .advance(u64::try_from(bytes).unwrap_or(0))
                .map_err(io)?;
        }
        rows += count;
    }
    if rows == 0 || columns.is_empty() {
        let message = "found a table without numbers, expected readings";
        return Err(ReadError::new(file, Location::File, message));
    }
    let mut series = Series {
        name: stem(file),
        rows,
        ..Series::default()
    };
    for column in columns {
        let place = format!("{file}, column {}", quoted(&column.name));
        let added = series.add(column.name, column.unit, column.cells);
        notices.extend(added.err().map(|why| format!("{place}: {why}")));
    }
    Ok(Source {
        file: file.into(),
        format: Format::Parquet,
        series: vec![series],
        notices,
    })
}

/// The columns to read; the others are reported in notices.
fn columns(
    reader: &SerializedFileReader<File>,
    file: &str,
    notices: &mut Vec<String>,
) -> Vec<ColumnBuilder> {
    let schema = reader.metadata().file_metadata().schema_descr();
    let mut columns = Vec::new();
    for (number, descriptor) in schema.columns().iter().enumerate() {
        let path = descriptor.path().parts().join(".");
        let mut leave_out = |why: &str| {
            notices.push(format!("{file}, column {}: {why}, left out", quoted(&path)));
        };
        if descriptor.max_rep_level() > 0 {
            leave_out("variable-length lists");
            continue;
        }
        let (name, stated) = split_heading(&path);
        match Content::of(descriptor) {
            Content::Numbers(scale) => columns.push(ColumnBuilder {
                number,
                level: descriptor.max_def_level(),
                name,
                unit: match scale {
                    Scale::Time(_) => Some("s".to_owned()),
                    _ => stated,
                },
                scale,
                cells: Filling::Numbers(Vec::new()),
            }),
            Content::Texts => columns.push(ColumnBuilder {
                number,
                level: descriptor.max_def_level(),
                name: path,
                unit: None,
                scale: Scale::Plain,
                cells: Filling::Texts(FillingTexts::default()),
            }),
            Content::Other => leave_out("neither numbers nor text"),
        }
    }
    columns
}

/// Conversion of the cells of a column.
#[derive(Clone, Copy)]
enum Scale {
    Plain,
    /// Unsigned integers.
    Unsigned,
    /// Times in this unit (s).
    Time(f64),
}

impl Scale {
    fn integer(self, signed: i64, unsigned: u64) -> f64 {
        match self {
            Self::Plain => signed as f64,
            Self::Unsigned => unsigned as f64,
            Self::Time(unit_s) => signed as f64 * unit_s,
        }
    }
}

/// Content of a column.
enum Content {
    Numbers(Scale),
    Texts,
    Other,
}

impl Content {
    fn of(descriptor: &ColumnDescriptor) -> Self {
        use parquet::basic::Type as Physical;
        let unit_s = |unit: &TimeUnit| match unit {
            TimeUnit::MILLIS => 1e-3,
            TimeUnit::MICROS => 1e-6,
            TimeUnit::NANOS => 1e-9,
        };
        let logical = descriptor.logical_type_ref();
        match (descriptor.physical_type(), logical) {
            (_, Some(LogicalType::Timestamp(kind) | LogicalType::Time(kind))) => {
                Self::Numbers(Scale::Time(unit_s(&kind.unit)))
            }
            (_, Some(LogicalType::Integer(kind))) if !kind.is_signed => {
                Self::Numbers(Scale::Unsigned)
            }
            (_, Some(LogicalType::Decimal(_))) => Self::Other,
            (Physical::BYTE_ARRAY, Some(LogicalType::String | LogicalType::Enum)) => Self::Texts,
            (Physical::BYTE_ARRAY, None)
                if matches!(
                    descriptor.converted_type(),
                    ConvertedType::NONE | ConvertedType::UTF8
                ) =>
            {
                Self::Texts
            }
            (
                Physical::BOOLEAN
                | Physical::INT32
                | Physical::INT64
                | Physical::FLOAT
                | Physical::DOUBLE,
                _,
            ) => Self::Numbers(Scale::Plain),
            _ => Self::Other,
        }
    }
}

impl ColumnBuilder {
    /// Adds the cells of a row group and returns their number.
    fn fill(&mut self, reader: ColumnReader, budget: &MemoryBudget) -> Result<usize, ParquetError> {
        let (level, scale) = (self.level, self.scale);
        match (&mut self.cells, reader) {
            (Filling::Texts(texts), ColumnReader::ByteArrayColumnReader(reader)) => {
                each(reader, level, budget, |cell: Option<&ByteArray>| {
                    let bytes = cell.map_or(&[][..], ByteArray::data);
                    texts.push(&String::from_utf8_lossy(bytes));
                })
            }
            (Filling::Numbers(values), reader) => {
                let mut push = |number: Option<f64>| values.push(number.unwrap_or(f64::NAN));
                use ColumnReader as C;
                match reader {
                    C::BoolColumnReader(reader) => each(reader, level, budget, |cell| {
                        push(cell.map(|on| u8::from(*on).into()));
                    }),
                    C::Int32ColumnReader(reader) => each(reader, level, budget, |cell| {
                        push(cell.map(|n| scale.integer((*n).into(), n.cast_unsigned().into())));
                    }),
                    C::Int64ColumnReader(reader) => each(reader, level, budget, |cell| {
                        push(cell.map(|n| scale.integer(*n, n.cast_unsigned())));
                    }),
                    C::FloatColumnReader(reader) => each(reader, level, budget, |cell| {
                        push(cell.map(|n| f64::from(*n)));
                    }),
                    C::DoubleColumnReader(reader) => each(reader, level, budget, |cell| {
                        push(cell.copied());
                    }),
                    _ => Ok(0),
                }
            }
            _ => Ok(0),
        }
    }
}

/// Visits the cells of a column, `None` for null, and returns their number.
fn each<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    level: i16,
    budget: &MemoryBudget,
    mut visit: impl FnMut(Option<&T::T>),
) -> Result<usize, ParquetError> {
    let mut count = 0;
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    loop {
        levels.clear();
        values.clear();
        let (records, _, _) = reader.read_records(ROWS, Some(&mut levels), None, &mut values)?;
        if records == 0 {
            return Ok(count);
        }
        count += records;
        // A page stores a run of equal values once, and of a text only the difference from the previous one.
        let sizes = values.iter().map(|value| value.as_bytes().len());
        let longer: usize = sizes.map(|size| size.saturating_sub(VALUE)).sum();
        let taken = budget.take((records * VALUE + longer) as u64);
        taken.map_err(|over| ParquetError::External(Box::new(over)))?;
        let mut values = values.iter();
        for row in 0..records {
            let is_there = level == 0 || levels.get(row) == Some(&level);
            let cell = is_there.then(|| values.next()).flatten();
            visit(cell);
        }
    }
}
