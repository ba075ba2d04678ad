//! MATLAB files of version 5 to 7.2: numeric arrays, also in structs and cells, compressed or not.
//!
//! A file is a header of 128 bytes and a sequence of elements: type and size, four bytes each, and the data, padded to
//! eight bytes; an element of up to four bytes is packed into the tag. An array is an element of elements: flags,
//! dimensions, name, and its data or, for structs and cells, arrays again.
//! Source: MAT-File Format, The MathWorks, R2019b.

use std::io::ErrorKind;

use flate2::read::ZlibDecoder;
use tautline_session::{Place, ReadError, quoted};

use super::{over_budget, stem, whole};
use crate::input::Input;
use crate::memory::{Lease, OverBudget};
use crate::source::{Channel, Format, Series, Source};
use crate::units::split_heading;

/// Deepest nesting of structs and cells that is followed.
const MAX_DEPTH: usize = 16;

const COMPRESSED: u32 = 15;
const MATRIX: u32 = 14;

pub(super) fn read(input: &mut Input<'_>, file: &str) -> Result<Source, ReadError> {
    let (bytes, memory) = whole(input, file)?;
    let over = |over| over_budget(file, over);
    let fail = |at: usize, message: &str| {
        ReadError::new(file, Place::File, format!("byte {at}: {message}"))
    };
    let swapped = match bytes.get(126..128) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(fail(126, "found no byte order, expected IM or MI")),
    };
    let mut found = Found {
        swapped,
        memory,
        over: None,
        arrays: Vec::new(),
        skipped: Vec::new(),
    };
    let add = |found: &mut Found, data: &[u8], at: usize| {
        let added = found.array(data, "", 0);
        match found.over {
            Some(over) => Err(fail(at, &format!("a variable {over}"))),
            None => {
                added.ok_or_else(|| fail(at, "found a damaged array, expected a complete variable"))
            }
        }
    };
    let mut rest = &bytes[128..];
    let mut cut = None;
    while !rest.is_empty() {
        let at = bytes.len() - rest.len();
        let Some((kind, data, next)) = element(rest, swapped) else {
            cut = Some(at);
            break;
        };
        match kind {
            COMPRESSED => {
                let mut inflating = input.budget().lease(0).map_err(over)?;
                let plain = inflating.read_to_end(ZlibDecoder::new(data));
                let plain = plain.map_err(|error| match error.kind() {
                    ErrorKind::OutOfMemory => fail(at, &format!("a variable {error}")),
                    _ => fail(
                        at,
                        "found damaged compressed data, expected a complete variable",
                    ),
                })?;
                let Some((MATRIX, data, _)) = element(&plain, swapped) else {
                    return Err(fail(
                        at,
                        "found compressed data without an array, expected a variable",
                    ));
                };
                add(&mut found, data, at)?;
            }
            MATRIX => add(&mut found, data, at)?,
            _ => found.skipped.push(format!("an element of type {kind}")),
        }
        rest = next;
    }
    let mut notices: Vec<String> = found
        .skipped
        .iter()
        .map(|what| format!("{file}: {what} left out"))
        .collect();
    if let Some(at) = cut {
        notices.push(format!(
            "{file}, byte {at}: the file ends in the middle of a variable: left out"
        ));
    }
    let series = series(found.arrays, &stem(file), file, &mut notices);
    if series.is_empty() {
        return Err(ReadError::new(
            file,
            Place::File,
            "found no numeric array of two rows or more, expected readings",
        ));
    }
    Ok(Source {
        file: file.into(),
        format: Format::Matlab,
        series,
        notices,
    })
}

/// A numeric array and where it was found.
struct Array {
    /// `log.winch(2).pos`
    path: String,
    rows: usize,
    columns: usize,
    /// Column by column.
    values: Vec<f64>,
}

struct Found {
    swapped: bool,
    /// Memory of the file and of the arrays.
    memory: Lease,
    /// Set where it does not suffice.
    over: Option<OverBudget>,
    arrays: Vec<Array>,
    skipped: Vec<String>,
}

/// Type and data of the first element, and what follows it.
fn element(bytes: &[u8], swapped: bool) -> Option<(u32, &[u8], &[u8])> {
    let first = word(bytes, 0, swapped)?;
    if first >> 16 != 0 {
        let size = (first >> 16) as usize;
        return Some((
            first & 0xffff,
            bytes.get(4..4 + size.min(4))?,
            bytes.get(8..)?,
        ));
    }
    let size = word(bytes, 4, swapped)? as usize;
    let end = 8_usize.checked_add(size)?;
    // Compressed elements are not padded; the last element of an array need not be.
    let padded = if first == COMPRESSED {
        end
    } else {
        end.next_multiple_of(8)
    };
    Some((
        first,
        bytes.get(8..end)?,
        bytes.get(padded..).unwrap_or_default(),
    ))
}

fn word(bytes: &[u8], at: usize, swapped: bool) -> Option<u32> {
    let bytes: [u8; 4] = bytes.get(at..at + 4)?.try_into().ok()?;
    Some(if swapped {
        u32::from_be_bytes(bytes)
    } else {
        u32::from_le_bytes(bytes)
    })
}

impl Found {
    /// Adds an array and those in it; `None` if it is damaged.
    fn array(&mut self, data: &[u8], parent: &str, depth: usize) -> Option<()> {
        if data.is_empty() {
            return Some(());
        }
        let (_, flags, rest) = element(data, self.swapped)?;
        let (_, dimensions, rest) = element(rest, self.swapped)?;
        let (_, name, rest) = element(rest, self.swapped)?;
        let flags = word(flags, 0, self.swapped)?;
        let (class, is_complex) = (flags & 0xff, flags & 0x800 != 0);
        let dimensions: Vec<usize> = (0..dimensions.len() / 4)
            .map(|k| word(dimensions, 4 * k, self.swapped).map(|size| size as usize))
            .collect::<Option<_>>()?;
        let count = dimensions
            .iter()
            .try_fold(1_usize, |product, size| product.checked_mul(*size))?;
        let path = match (parent, String::from_utf8_lossy(name)) {
            ("", name) => name.into_owned(),
            (parent, _) => parent.to_owned(),
        };
        let skip = |what: &str| format!("variable {} ({what})", quoted(&path));
        if depth > MAX_DEPTH {
            self.skipped.push(skip("nested too deeply"));
            return Some(());
        }
        match class {
            1 => self.cells(rest, &path, count, depth),
            2 => self.fields(rest, &path, count, depth),
            4 => Some(()),
            6..=15 => {
                let (kind, numbers, _) = element(rest, self.swapped)?;
                // A byte may be a value of its own.
                let taken = self.memory.take_values::<f64>(count.min(numbers.len()));
                if let Err(over) = taken {
                    self.over = Some(over);
                    return None;
                }
                let values = self.numbers(kind, numbers)?;
                if values.len() != count {
                    return None;
                }
                match dimensions[..] {
                    [rows, columns] if is_complex => {
                        self.skipped.push(skip("complex"));
                        let _ = (rows, columns);
                    }
                    [1, columns] => self.arrays.push(Array {
                        path,
                        rows: columns,
                        columns: 1,
                        values,
                    }),
                    [rows, columns] => self.arrays.push(Array {
                        path,
                        rows,
                        columns,
                        values,
                    }),
                    _ => self.skipped.push(skip("more than two dimensions")),
                }
                Some(())
            }
            _ => {
                self.skipped.push(skip(match class {
                    3 => "object",
                    5 => "sparse",
                    16 => "function",
                    _ => "of an undocumented class",
                }));
                Some(())
            }
        }
    }

    fn cells(&mut self, mut rest: &[u8], path: &str, count: usize, depth: usize) -> Option<()> {
        for k in 0..count {
            let (_, data, next) = element(rest, self.swapped)?;
            self.array(data, &format!("{path}{{{}}}", k + 1), depth + 1)?;
            rest = next;
        }
        Some(())
    }

    fn fields(&mut self, rest: &[u8], path: &str, count: usize, depth: usize) -> Option<()> {
        let (_, length, rest) = element(rest, self.swapped)?;
        let length = word(length, 0, self.swapped)? as usize;
        let (_, names, mut rest) = element(rest, self.swapped)?;
        let names: Vec<String> = match length {
            0 => return None,
            length => names
                .chunks_exact(length)
                .map(|name| {
                    String::from_utf8_lossy(
                        name.split(|byte| *byte == 0).next().unwrap_or_default(),
                    )
                    .into_owned()
                })
                .collect(),
        };
        for k in 0..count {
            for name in &names {
                let (_, data, next) = element(rest, self.swapped)?;
                let index = if count == 1 {
                    String::new()
                } else {
                    format!("({})", k + 1)
                };
                self.array(data, &format!("{path}{index}.{name}"), depth + 1)?;
                rest = next;
            }
        }
        Some(())
    }

    /// Numbers as they are stored, which may be narrower than the array's class.
    fn numbers(&self, kind: u32, bytes: &[u8]) -> Option<Vec<f64>> {
        macro_rules! read {
            ($type:ty) => {
                bytes
                    .chunks_exact(size_of::<$type>())
                    .map(|chunk| {
                        let chunk = chunk.try_into().ok()?;
                        let value = if self.swapped {
                            <$type>::from_be_bytes(chunk)
                        } else {
                            <$type>::from_le_bytes(chunk)
                        };
                        Some(value as f64)
                    })
                    .collect()
            };
        }
        match kind {
            1 => read!(i8),
            2 => read!(u8),
            3 => read!(i16),
            4 => read!(u16),
            5 => read!(i32),
            6 => read!(u32),
            7 => read!(f32),
            9 => read!(f64),
            12 => read!(i64),
            13 => read!(u64),
            _ => None,
        }
    }
}

/// Arrays of one variable with the same number of rows become a series.
fn series(arrays: Vec<Array>, stem: &str, file: &str, notices: &mut Vec<String>) -> Vec<Series> {
    let mut series: Vec<(String, Series)> = Vec::new();
    for array in arrays {
        let Array {
            path,
            rows,
            columns,
            values,
        } = array;
        if rows < 2 || columns == 0 {
            notices.push(format!(
                "{file}: variable {} of {rows} x {columns} left out: not readings",
                quoted(&path)
            ));
            continue;
        }
        let owner = match path.find(['.', '{', '(']) {
            Some(end) => path[..end].to_owned(),
            None => String::new(),
        };
        let known = series
            .iter()
            .position(|(of, series)| *of == owner && series.rows == rows);
        let place = known.unwrap_or_else(|| {
            let name = match series.len() {
                0 => stem.to_owned(),
                count => format!("{stem} ({})", count + 1),
            };
            series.push((
                owner,
                Series {
                    name,
                    rows,
                    ..Series::default()
                },
            ));
            series.len() - 1
        });
        for (k, column) in values.chunks_exact(rows).enumerate() {
            let (name, unit) = split_heading(&path);
            let name = if columns == 1 {
                name
            } else {
                format!("{name}(:,{})", k + 1)
            };
            let values = column
                .iter()
                .map(|value| if value.is_finite() { *value } else { f64::NAN })
                .collect();
            series[place]
                .1
                .channels
                .push(Channel { name, unit, values });
        }
    }
    series.into_iter().map(|(_, series)| series).collect()
}
