//! NumPy arrays: `.npy`, and `.npz`, which is a zip archive of them.
//!
//! The crates that read `.npy` bring a parser generator for the Python dictionary of the header; its three keys are read
//! here. Source: NumPy Enhancement Proposal 1, format versions 1 to 3.

use tautline_files::{Location, ReadError, quoted};

use super::archive::Archive;
use super::{stem, whole};
use crate::input::Input;
use crate::memory::MemoryBudget;
use crate::source::{Channel, FillingTexts, Format, Series, Source};
use crate::units::split_heading;

pub(super) fn read(mut input: Input<'_>, head: &[u8], file: &str) -> Result<Source, ReadError> {
    let mut source = Source {
        file: file.into(),
        format: Format::NumPy,
        series: Vec::new(),
        notices: Vec::new(),
    };
    let budget = input.budget();
    if head.starts_with(b"\x93NUMPY") {
        let bytes = whole(&mut input, file)?;
        add(&mut source, "", &bytes, budget)?;
    } else {
        let fail = |message: String| ReadError::new(file, Location::File, message);
        let bytes = whole(&mut input, file)?;
        let archive = Archive::open(&bytes).map_err(fail)?;
        for name in archive.names() {
            let Some(array) = name.strip_suffix(".npy") else {
                source
                    .notices
                    .push(format!("{file}: {} left out: not an array", quoted(name)));
                continue;
            };
            let bytes = archive.read(name, &budget.temporary()).map_err(fail)?;
            add(&mut source, array, &bytes.unwrap_or_default(), budget)?;
        }
    }
    if source.series.is_empty() {
        return Err(ReadError::new(
            file,
            Location::File,
            "found no array of two rows or more, expected readings",
        ));
    }
    Ok(source)
}

/// Type of a field: type character and size in bytes.
#[derive(Debug, Clone, PartialEq)]
struct Field {
    name: String,
    letter: u8,
    size: usize,
    big_endian: bool,
    /// Number of elements per row.
    count: usize,
}

#[derive(Debug, PartialEq)]
struct Header {
    fields: Vec<Field>,
    is_record: bool,
    fortran: bool,
    shape: Vec<usize>,
}

/// Adds an array to the series. Its values count, since a byte may be a value, and entries of an archive may be the same bytes.
fn add(
    source: &mut Source,
    name: &str,
    bytes: &[u8],
    budget: &MemoryBudget,
) -> Result<(), ReadError> {
    let file = source.file.clone();
    let what = if name.is_empty() {
        String::new()
    } else {
        format!("array {}: ", quoted(name))
    };
    let fail = |message: String| ReadError::new(&file, Location::File, format!("{what}{message}"));
    let (header, data) = header(bytes).map_err(fail)?;
    let (rows, columns) = match header.shape[..] {
        [rows] => (rows, 1),
        [1, columns] if columns > 1 => (columns, 1),
        [rows, columns] => (rows, columns),
        _ => {
            let shape = &header.shape;
            source.notices.push(format!(
                "{file}: {what}an array of shape {shape:?} left out: not a table"
            ));
            return Ok(());
        }
    };
    if rows < 2 || columns == 0 {
        source.notices.push(format!(
            "{file}: {what}{rows} x {columns} values left out: not readings"
        ));
        return Ok(());
    }
    let row_bytes: usize = header
        .fields
        .iter()
        .map(|field| field.size.saturating_mul(field.count))
        .sum();
    let needed = row_bytes
        .checked_mul(columns)
        .and_then(|bytes| bytes.checked_mul(rows));
    if needed.is_none_or(|needed| data.len() < needed) {
        let expected = needed.map_or_else(|| "fewer".into(), |needed| needed.to_string());
        return Err(fail(format!(
            "found {} bytes of data, expected {expected}",
            data.len()
        )));
    }
    let known = source.series.iter().position(|series| series.rows == rows);
    let place = known.unwrap_or_else(|| {
        let name = match source.series.len() {
            0 => stem(&file),
            count => format!("{} ({})", stem(&file), count + 1),
        };
        source.series.push(Series {
            name,
            rows,
            ..Series::default()
        });
        source.series.len() - 1
    });
    let series = &mut source.series[place];
    let mut offset = 0;
    for field in &header.fields {
        for part in 0..columns * field.count {
            let title = match (header.is_record, name, columns * field.count) {
                (true, "", 1) => field.name.clone(),
                (true, "", _) => format!("{}[{part}]", field.name),
                (true, name, 1) => format!("{name}.{}", field.name),
                (true, name, _) => format!("{name}.{}[{part}]", field.name),
                (false, "", 1) => "values".into(),
                (false, "", _) => format!("column {}", part + 1),
                (false, name, 1) => name.into(),
                (false, name, _) => format!("{name}[{part}]"),
            };
            let (title, unit) = split_heading(&title);
            let at = |row: usize| match (header.is_record, header.fortran) {
                (true, _) => row * row_bytes + offset + part * field.size,
                (false, true) => (part * rows + row) * field.size,
                (false, false) => (row * columns + part) * field.size,
            };
            let cell = |row: usize| data.get(at(row)..at(row) + field.size).unwrap_or_default();
            let taken = budget.take((rows * field.size.max(size_of::<f64>())) as u64);
            taken.map_err(|over| fail(over.to_string()))?;
            match field.letter {
                b'U' | b'S' => {
                    let mut texts = FillingTexts::default();
                    (0..rows).for_each(|row| texts.push(&text(field, cell(row))));
                    match texts.finish(&title) {
                        Ok(texts) => series.texts.push(texts),
                        Err(why) => source
                            .notices
                            .push(format!("{file}, column {}: {why}", quoted(&title))),
                    }
                }
                _ => series.channels.push(Channel {
                    name: title,
                    unit,
                    values: (0..rows).map(|row| number(field, cell(row))).collect(),
                }),
            }
        }
        offset += field.size * field.count;
    }
    Ok(())
}

fn text(field: &Field, bytes: &[u8]) -> String {
    let letters: String = match field.letter {
        b'U' => bytes
            .chunks_exact(4)
            .filter_map(|c| {
                let code = [c[0], c[1], c[2], c[3]];
                char::from_u32(if field.big_endian {
                    u32::from_be_bytes(code)
                } else {
                    u32::from_le_bytes(code)
                })
            })
            .collect(),
        _ => String::from_utf8_lossy(bytes).into_owned(),
    };
    letters.trim_end_matches('\0').to_owned()
}

/// A number of any type; NaN if it is not finite.
fn number(field: &Field, bytes: &[u8]) -> f64 {
    let mut little = [0_u8; 8];
    let Some(slot) = little.get_mut(..bytes.len()) else {
        return f64::NAN;
    };
    slot.copy_from_slice(bytes);
    if field.big_endian {
        slot.reverse();
    }
    let bits = u64::from_le_bytes(little);
    let value = match (field.letter, field.size) {
        (b'f', 8) => f64::from_bits(bits),
        (b'f', 4) => f64::from(f32::from_bits(bits as u32)),
        (b'i', size) => {
            let unused = 64 - 8 * size as u32;
            ((bits << unused) as i64 >> unused) as f64
        }
        _ => bits as f64,
    };
    if value.is_finite() { value } else { f64::NAN }
}

/// The header and the data after it.
fn header(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    let cut = || "ends in its header, expected an array".to_owned();
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err("found no NumPy magic number at its beginning, expected an array".into());
    }
    let (start, length) = match bytes.get(6) {
        Some(1) => (
            10,
            bytes
                .get(8..10)
                .map(|b| usize::from(u16::from_le_bytes([b[0], b[1]]))),
        ),
        Some(2 | 3) => (
            12,
            bytes
                .get(8..12)
                .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize),
        ),
        Some(version) => return Err(format!("found format version {version}, expected 1 to 3")),
        None => return Err(cut()),
    };
    let end = start + length.ok_or_else(cut)?;
    let text = String::from_utf8_lossy(bytes.get(start..end).ok_or_else(cut)?).into_owned();
    let after = |key: &str| {
        let at = text
            .find(&format!("'{key}'"))
            .ok_or_else(|| format!("found no {key} in its header"))?;
        let rest = &text[at + key.len() + 2..];
        Ok::<&str, String>(rest.trim_start().trim_start_matches(':').trim_start())
    };
    let (fields, is_record) = fields(after("descr")?)?;
    let fortran = after("fortran_order")?.starts_with("True");
    let shape = after("shape")?.trim_start_matches('(');
    let shape = shape
        .split(')')
        .next()
        .unwrap_or_default()
        .split(',')
        .map(str::trim);
    let shape = shape
        .filter(|size| !size.is_empty())
        .map(|size| size.trim_end_matches('L').parse());
    let shape: Vec<usize> = shape
        .collect::<Result<_, _>>()
        .map_err(|_| "found an invalid shape in its header".to_owned())?;
    Ok((
        Header {
            fields,
            is_record,
            fortran,
            shape,
        },
        &bytes[end..],
    ))
}

/// `'<f8'`, or `[('a', '<f8'), ('b', '<i4', (3,))]`.
fn fields(descr: &str) -> Result<(Vec<Field>, bool), String> {
    if !descr.starts_with('[') {
        let name = descr
            .trim_start_matches('\'')
            .split('\'')
            .next()
            .unwrap_or_default();
        return Ok((vec![field("", name, 1)?], false));
    }
    let end = descr
        .find(']')
        .ok_or("found an unterminated list of types")?;
    let mut fields = Vec::new();
    for record in descr[1..end].split("('").skip(1) {
        let mut parts = record.split('\'');
        let name = parts.next().unwrap_or_default();
        let kind = parts.nth(1).ok_or_else(|| {
            format!(
                "found a nested type in the field {}, expected numbers",
                quoted(name)
            )
        })?;
        let rest = parts
            .next()
            .unwrap_or_default()
            .trim_start_matches([',', ' ']);
        let count = match rest.strip_prefix('(') {
            Some(shape) => {
                let sizes = shape.split(')').next().unwrap_or_default().split(',');
                let sizes = sizes
                    .map(str::trim)
                    .filter(|size| !size.is_empty())
                    .map(str::parse::<usize>);
                let sizes: Vec<usize> = sizes
                    .collect::<Result<_, _>>()
                    .map_err(|_| "found an invalid shape in its header".to_owned())?;
                sizes
                    .iter()
                    .try_fold(1_usize, |product, size| product.checked_mul(*size))
                    .ok_or("found a shape that is too large")?
            }
            None => 1,
        };
        fields.push(field(name, kind, count)?);
    }
    if fields.is_empty() {
        Err("found a record without fields".into())
    } else {
        Ok((fields, true))
    }
}

fn field(name: &str, kind: &str, count: usize) -> Result<Field, String> {
    let unknown = || {
        format!(
            "found values of type {}, expected real numbers or text",
            quoted(kind)
        )
    };
    let order = kind.as_bytes().first().copied().ok_or_else(unknown)?;
    let rest = kind.trim_start_matches(['<', '>', '|', '=']);
    let letter = rest.as_bytes().first().copied().ok_or_else(unknown)?;
    let size: usize = rest
        .get(1..)
        .and_then(|size| size.parse().ok())
        .ok_or_else(unknown)?;
    let size = match (letter, size) {
        (b'f', 4 | 8) | (b'i' | b'u', 1 | 2 | 4 | 8) | (b'b', 1) => size,
        (b'S', 1..=4096) => size,
        (b'U', 1..=1024) => 4 * size,
        _ => return Err(unknown()),
    };
    Ok(Field {
        name: name.into(),
        letter,
        size,
        big_endian: order == b'>',
        count,
    })
}
