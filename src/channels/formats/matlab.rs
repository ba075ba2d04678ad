//! MATLAB files of version 5 to 7.2: numeric arrays, also in structs and cells, compressed or not.
//!
//! A file is a header of 128 bytes and a sequence of elements: type and size, four bytes each, and the data, padded to
//! eight bytes; an element of up to four bytes is packed into the tag. An array is an element of elements: flags,
//! dimensions, name, and its data or, for structs and cells, arrays again. An object has flags, name, the type system
//! (`MCOS`) and its class; its properties are in an array without a name, in a format that is not published.
//!
//! A field that has the same few values in every element of a struct array, or of a cell array, fewer than elements, is a table
//! with one row per element.
//! Source: MAT-File Format, The MathWorks, R2019b.

use flate2::read::ZlibDecoder;
use tautline_files::{Location, ReadError, quoted};

use super::fault::Fault;
use super::{stem, whole};
use crate::input::Input;
use crate::memory::MemoryBudget;
use crate::source::{Channel, FillingTexts, Format, Series, Source, owner_of};
use crate::units::split_heading;

/// Deepest nesting of structs and cells that is followed.
const MAX_DEPTH: usize = 16;
/// Most values of an element of a struct array that become columns of a table.
const MAX_MERGED: usize = 64;

const UINT16: u32 = 4;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const UTF8: u32 = 16;
const UTF16: u32 = 17;
/// Class of arrays that are objects.
const OPAQUE: u32 = 17;

pub(super) fn read(input: &mut Input<'_>, file: &str) -> Result<Source, ReadError> {
    let bytes = whole(input, file)?;
    let fail = |at: usize, message: &str| {
        ReadError::new(file, Location::File, format!("byte {at}: {message}"))
    };
    let refuse = |at: usize, fault: Fault, damaged: &str| match fault {
        Fault::Damaged => fail(at, damaged),
        Fault::Large(over) => fail(at, &format!("a variable {over}")),
    };
    let swapped = match bytes.get(126..128) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(fail(126, "found no byte order, expected IM or MI")),
    };
    let mut found = Found {
        swapped,
        budget: input.budget(),
        arrays: Vec::new(),
        texts: Vec::new(),
        skipped: Vec::new(),
    };
    let add = |found: &mut Found, data: &[u8], at: usize| {
        let damaged = "found a damaged array, expected a complete variable";
        let added = found.array(data, None, 0);
        added.map_err(|fault| refuse(at, fault, damaged))
    };
    let mut rest = &bytes[128..];
    let mut cut = None;
    while !rest.is_empty() {
        let at = bytes.len() - rest.len();
        let Ok((kind, data, next)) = element(rest, swapped) else {
            cut = Some(at);
            break;
        };
        match kind {
            COMPRESSED => {
                let damaged = "found damaged compressed data, expected a complete variable";
                let plain = found.budget.temporary().read_to_end(ZlibDecoder::new(data));
                let plain = plain.map_err(|error| refuse(at, error.into(), damaged))?;
                let Ok((MATRIX, data, _)) = element(&plain, swapped) else {
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
    let series = series(found, &stem(file), file, &mut notices);
    if series.is_empty() {
        // A file of objects only is refused with advice.
        let why = notices.first().map_or_else(String::new, |notice| {
            format!(" ({})", notice.trim_start_matches(&format!("{file}: ")))
        });
        let message = format!("found no numeric array of two rows or more, expected readings{why}");
        return Err(ReadError::new(file, Location::File, message));
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

/// Text, or a column of it.
struct Texts {
    path: String,
    rows: Vec<String>,
}

struct Found<'a> {
    swapped: bool,
    budget: &'a MemoryBudget,
    arrays: Vec<Array>,
    texts: Vec<Texts>,
    skipped: Vec<String>,
}

/// Type and data of the first element, and what follows it.
fn element(bytes: &[u8], swapped: bool) -> Result<(u32, &[u8], &[u8]), Fault> {
    let first = word(bytes, 0, swapped)?;
    if first >> 16 != 0 {
        let size = (first >> 16) as usize;
        let data = bytes.get(4..4 + size.min(4)).ok_or(Fault::Damaged)?;
        let rest = bytes.get(8..).ok_or(Fault::Damaged)?;
        return Ok((first & 0xffff, data, rest));
    }
    let size = word(bytes, 4, swapped)? as usize;
    let end = 8_usize.checked_add(size).ok_or(Fault::Damaged)?;
    // Compressed elements are not padded; the last element of an array need not be.
    let padded = if first == COMPRESSED {
        end
    } else {
        end.next_multiple_of(8)
    };
    Ok((
        first,
        bytes.get(8..end).ok_or(Fault::Damaged)?,
        bytes.get(padded..).unwrap_or_default(),
    ))
}

fn word(bytes: &[u8], at: usize, swapped: bool) -> Result<u32, Fault> {
    let word = bytes.get(at..).and_then(<[u8]>::first_chunk);
    let bytes = *word.ok_or(Fault::Damaged)?;
    Ok(if swapped {
        u32::from_be_bytes(bytes)
    } else {
        u32::from_le_bytes(bytes)
    })
}

impl Found<'_> {
    /// Adds an array and those in it. `path` is its place in a variable.
    fn array(&mut self, data: &[u8], path: Option<&str>, depth: usize) -> Result<(), Fault> {
        if data.is_empty() {
            return Ok(());
        }
        let (_, flags, rest) = element(data, self.swapped)?;
        let flags = word(flags, 0, self.swapped)?;
        let (class, is_complex) = (flags & 0xff, flags & 0x800 != 0);
        if class == OPAQUE {
            return self.object(rest, path);
        }
        let (_, dimensions, rest) = element(rest, self.swapped)?;
        let (_, name, rest) = element(rest, self.swapped)?;
        let dimensions: Vec<usize> = (0..dimensions.len() / 4)
            .map(|k| word(dimensions, 4 * k, self.swapped).map(|size| size as usize))
            .collect::<Result<_, _>>()?;
        let count = dimensions
            .iter()
            .try_fold(1_usize, |product, size| product.checked_mul(*size))
            .ok_or(Fault::Damaged)?;
        let name = String::from_utf8_lossy(name);
        // Properties of objects.
        if path.is_none() && name.is_empty() {
            return Ok(());
        }
        let path = path.map_or_else(|| name.into_owned(), str::to_owned);
        let skip = |what: &str| format!("variable {} ({what})", quoted(&path));
        if depth > MAX_DEPTH {
            self.skipped.push(skip("nested too deeply"));
            return Ok(());
        }
        match class {
            1 => self.cells(rest, &path, count, depth),
            2 => self.fields(rest, &path, count, depth),
            4 => self.text(rest, path),
            6..=15 => {
                let (kind, numbers, _) = element(rest, self.swapped)?;
                // A byte may be a value of its own.
                self.budget.take_values(count.min(numbers.len()))?;
                let values = self.numbers(kind, numbers)?;
                if values.len() != count {
                    return Err(Fault::Damaged);
                }
                match dimensions[..] {
                    [_, _] if is_complex => self.skipped.push(skip("complex")),
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
                Ok(())
            }
            _ => {
                self.skipped.push(skip(match class {
                    3 => "object",
                    5 => "sparse",
                    16 => "function",
                    _ => "of an undocumented class",
                }));
                Ok(())
            }
        }
    }

    /// Names an object that cannot be read.
    fn object(&mut self, rest: &[u8], path: Option<&str>) -> Result<(), Fault> {
        let (_, name, rest) = element(rest, self.swapped)?;
        let (_, _, rest) = element(rest, self.swapped)?;
        let (_, class, _) = element(rest, self.swapped)?;
        let path = path.map_or_else(|| String::from_utf8_lossy(name), Into::into);
        let class = String::from_utf8_lossy(class);
        let what = format!("variable {}, {},", quoted(&path), object(&class));
        self.skipped.push(what);
        Ok(())
    }

    /// Adds a text in one row.
    fn text(&mut self, rest: &[u8], path: String) -> Result<(), Fault> {
        let (kind, letters, _) = element(rest, self.swapped)?;
        let text = match kind {
            UTF8 => String::from_utf8_lossy(letters).into_owned(),
            UTF16 => {
                let words = self.numbers(UINT16, letters)?;
                let words: Vec<u16> = words.iter().map(|word| *word as u16).collect();
                String::from_utf16_lossy(&words)
            }
            _ => {
                let codes = self.numbers(kind, letters)?;
                let letters = codes.iter().map(|code| char::from_u32(*code as u32));
                letters.map(|letter| letter.unwrap_or('?')).collect()
            }
        };
        self.texts.push(Texts {
            path,
            rows: vec![text],
        });
        Ok(())
    }

    fn cells(
        &mut self,
        mut rest: &[u8],
        path: &str,
        count: usize,
        depth: usize,
    ) -> Result<(), Fault> {
        let mut elements = Vec::new();
        for k in 0..count {
            let (_, data, next) = element(rest, self.swapped)?;
            let mut within = self.below();
            within.array(data, Some(""), depth + 1)?;
            elements.push((format!("{path}{{{}}}", k + 1), within));
            rest = next;
        }
        self.merge(path, elements);
        Ok(())
    }

    fn fields(&mut self, rest: &[u8], path: &str, count: usize, depth: usize) -> Result<(), Fault> {
        let (_, length, rest) = element(rest, self.swapped)?;
        let length = word(length, 0, self.swapped)? as usize;
        let (_, names, mut rest) = element(rest, self.swapped)?;
        let names: Vec<String> = match length {
            0 => return Err(Fault::Damaged),
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
        let mut elements = Vec::new();
        for k in 0..count {
            let mut within = self.below();
            for name in &names {
                let (_, data, next) = element(rest, self.swapped)?;
                within.array(data, Some(&format!(".{name}")), depth + 1)?;
                rest = next;
            }
            let place = match count {
                1 => path.to_owned(),
                _ => format!("{path}({})", k + 1),
            };
            elements.push((place, within));
        }
        self.merge(path, elements);
        Ok(())
    }

    /// An empty result within the same file.
    fn below(&self) -> Self {
        Self {
            swapped: self.swapped,
            budget: self.budget,
            arrays: Vec::new(),
            texts: Vec::new(),
            skipped: Vec::new(),
        }
    }

    /// Adds the elements of a struct array or cell array with their places. A field with the same number of values in each of
    /// them, or none, becomes a table with one row per element.
    fn merge(&mut self, path: &str, mut elements: Vec<(String, Self)>) {
        let count = elements.len();
        let mut names: Vec<String> = Vec::new();
        for (_, within) in &elements {
            let arrays = within.arrays.iter().map(|array| &array.path);
            for name in arrays.chain(within.texts.iter().map(|texts| &texts.path)) {
                if !names.contains(name) {
                    names.push(name.clone());
                }
            }
        }
        for name in names.iter().filter(|_| count > 1) {
            let path = format!("{path}{name}");
            if let Some(merged) = merged_numbers(&path, name, &mut elements) {
                self.arrays.push(merged);
            } else if let Some(merged) = merged_texts(&path, name, &mut elements) {
                self.texts.push(merged);
            }
        }
        for (place, within) in elements {
            let named = |name: String| format!("{place}{name}");
            self.arrays
                .extend(within.arrays.into_iter().map(|array| Array {
                    path: named(array.path),
                    ..array
                }));
            self.texts
                .extend(within.texts.into_iter().map(|texts| Texts {
                    path: named(texts.path),
                    ..texts
                }));
            // The notice has the place of the variable.
            self.skipped.extend(
                within
                    .skipped
                    .into_iter()
                    .map(|what| what.replacen("variable \"", &format!("variable \"{place}"), 1)),
            );
        }
    }

    /// Numbers as they are stored, which may be narrower than the array's class.
    fn numbers(&self, kind: u32, bytes: &[u8]) -> Result<Vec<f64>, Fault> {
        macro_rules! read {
            ($type:ty) => {
                bytes
                    .chunks_exact(size_of::<$type>())
                    .map(|chunk| {
                        let chunk = chunk.try_into().map_err(|_| Fault::Damaged)?;
                        let value = if self.swapped {
                            <$type>::from_be_bytes(chunk)
                        } else {
                            <$type>::from_le_bytes(chunk)
                        };
                        Ok(value as f64)
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
            _ => Err(Fault::Damaged),
        }
    }
}

/// Takes the numbers of this name out of all elements, if they are as many everywhere and fewer than the elements, which then
/// are samples; an empty array is a missing row.
fn merged_numbers(path: &str, name: &str, elements: &mut [(String, Found<'_>)]) -> Option<Array> {
    let of = |within: &Found<'_>| {
        let arrays = &within.arrays;
        arrays.iter().position(|array| array.path == name)
    };
    let rows = elements.len();
    let mut columns = 0;
    for (_, within) in &*elements {
        let size = within.arrays[of(within)?].values.len();
        if size > MAX_MERGED || size >= rows || size > 0 && columns > 0 && size != columns {
            return None;
        }
        columns = columns.max(size);
    }
    let mut values = vec![f64::NAN; rows * columns];
    for (row, (_, within)) in elements.iter_mut().enumerate() {
        let array = within.arrays.remove(of(within)?);
        for (column, value) in array.values.iter().enumerate() {
            values[column * rows + row] = *value;
        }
    }
    Some(Array {
        path: path.to_owned(),
        rows,
        columns,
        values,
    })
}

/// Takes the texts of this name out of all elements, if each has one.
fn merged_texts(path: &str, name: &str, elements: &mut [(String, Found<'_>)]) -> Option<Texts> {
    let of = |within: &Found<'_>| {
        let texts = &within.texts;
        texts
            .iter()
            .position(|one| one.path == name && one.rows.len() == 1)
    };
    if !elements.iter().all(|(_, within)| of(within).is_some()) {
        return None;
    }
    let mut rows = Vec::new();
    for (_, within) in elements {
        let place = of(within)?;
        rows.extend(within.texts.remove(place).rows);
    }
    Some(Texts {
        path: path.to_owned(),
        rows,
    })
}

/// Class of an object, and advice how to save its content as arrays.
pub(super) fn object(class: &str) -> String {
    let advice = match class {
        "timeseries" => "save its Time and Data as arrays",
        "timetable" => "save its variables and seconds(RowTimes) as arrays, or use writetimetable",
        "table" => "save table2struct(.., 'ToScalar', true), or use writetable",
        "datetime" => "save posixtime(..)",
        "duration" => "save seconds(..)",
        "string" => "save cellstr(..)",
        "categorical" => "save double(..)",
        _ => "save its properties as arrays",
    };
    format!("an object of class {} ({advice})", quoted(class))
}

/// Arrays of one variable with the same number of rows become a series.
fn series(found: Found<'_>, stem: &str, file: &str, notices: &mut Vec<String>) -> Vec<Series> {
    let mut series = Grouped {
        stem,
        series: Vec::new(),
    };
    for array in found.arrays {
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
        let channels = &mut series.of(&path, rows).channels;
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
            channels.push(Channel { name, unit, values });
        }
    }
    for texts in found.texts.into_iter().filter(|texts| texts.rows.len() > 1) {
        let mut filling = FillingTexts::default();
        texts.rows.iter().for_each(|text| filling.push(text));
        match filling.finish(&texts.path) {
            Ok(channel) => series.of(&texts.path, texts.rows.len()).texts.push(channel),
            Err(why) => notices.push(format!("{file}: variable {}: {why}", quoted(&texts.path))),
        }
    }
    let series = series.series.into_iter().map(|(_, series)| series);
    series
        .filter(|series| !series.channels.is_empty())
        .collect()
}

/// Series of one file, each with the variable that it belongs to.
struct Grouped<'a> {
    stem: &'a str,
    series: Vec<(String, Series)>,
}

impl Grouped<'_> {
    /// The series of a path that has as many rows.
    fn of(&mut self, path: &str, rows: usize) -> &mut Series {
        let owner = owner_of(path);
        let known = self
            .series
            .iter()
            .position(|(of, series)| of == owner && series.rows == rows);
        let place = known.unwrap_or_else(|| {
            let name = match self.series.len() {
                0 => self.stem.to_owned(),
                count => format!("{} ({})", self.stem, count + 1),
            };
            let series = Series {
                name,
                rows,
                ..Series::default()
            };
            self.series.push((owner.to_owned(), series));
            self.series.len() - 1
        });
        &mut self.series[place].1
    }
}
