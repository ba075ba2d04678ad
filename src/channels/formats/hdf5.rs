//! HDF5 files, including MATLAB files of version 7.3: arrays in groups, read in windows of rows.
//!
//! MATLAB stores its arrays transposed, names their class in an attribute, and keeps the targets of cells and objects in
//! groups whose names begin with `#`.

use std::collections::HashMap;
use std::fs::File as Opened;
use std::io::{Read, Seek, SeekFrom};
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread::{Builder, scope};

use hdf5_pure::{
    AttrValue, ChunkIndex, Dataset, Datatype, Error, File, FileAccessProperties, FormatError,
    Group, Layout, MetadataCacheConfig, ReadSeekSource,
};
use tautline_files::{Location, ReadError, quoted, read_damaged};

use super::hdf5_elements::{Cell, Field, fields_of, joined, text};
use super::matlab::object;
use super::stem;
use crate::input::Input;
use crate::memory::MemoryBudget;
use crate::source::{Filling, FillingTexts, Format, Series, Source};
use crate::units::{bare, split_heading};

/// Bytes of an array that are decoded at a time, unless its chunks in the file are larger.
const WINDOW: u64 = 1 << 20;
/// Number of variable-length texts decoded at a time.
const TEXTS: u64 = 1 << 12;
/// Maximum size of cached metadata (bytes).
const STRUCTURE: usize = 8 << 20;
/// Stack of the reader (bytes): the crate follows types in types as deep as the 64 kB of their description go.
const STACK: usize = 16 << 20;
/// Deepest nesting of groups that is followed.
const MAX_DEPTH: usize = 16;
/// Most groups and arrays of a file: links may form circles.
const MAX_OBJECTS: usize = 100_000;
/// Maximum number of columns of an array: images have more.
const MAX_COLUMNS: u64 = 4096;
/// Maximum number of rows of an array with more than `MAX_COLUMNS` columns, whose rows are then taken as channels.
const MAX_CHANNELS: u64 = 64;
/// Maximum ratio of decoded content to file size: the limit of gzip (deflate).
const MAX_RATIO: u64 = 1032;
/// The filters that are read: gzip, shuffle, Fletcher-32, scale-offset and LZF.
const FILTERS: [u16; 5] = [1, 2, 3, 6, 32000];

pub(super) fn read(input: &mut Input<'_>, format: Format, file: &str) -> Result<Source, ReadError> {
    let io = |error: std::io::Error| ReadError::io(file, Location::File, &error);
    let opened = input.file().map_err(io)?;
    let (progress, reports) = channel();
    let budget = input.budget();
    scope(|threads| {
        let read = || {
            read_damaged(|| read_file(opened, progress, (format, budget), file)).unwrap_or_else(
                || {
                    let message = "is damaged, expected HDF5";
                    Err(ReadError::new(file, Location::File, message))
                },
            )
        };
        let thread = Builder::new().stack_size(STACK);
        let thread = thread.spawn_scoped(threads, read).map_err(io)?;
        // If reading is stopped, the thread fails as it finds the channel closed.
        let ended = reports
            .into_iter()
            .try_for_each(|bytes| input.advance(bytes));
        let read = thread.join();
        ended.map_err(io)?;
        read.unwrap_or_else(|panic| resume_unwind(panic))
    })
}

fn read_file(
    opened: Opened,
    progress: Sender<u64>,
    (format, budget): (Format, &MemoryBudget),
    file: &str,
) -> Result<Source, ReadError> {
    let io = |error: std::io::Error| ReadError::io(file, Location::File, &error);
    let bytes = opened.metadata().map_err(io)?.len();
    let counted = Counted {
        file: opened,
        read: Arc::default(),
    };
    let mut reader = Reader {
        file,
        is_matlab: format == Format::Matlab,
        read: Arc::clone(&counted.read),
        progress,
        bytes,
        left: bytes.saturating_mul(MAX_RATIO),
        budget,
        objects: 0,
        series: Vec::new(),
        notices: Vec::new(),
    };
    let options =
        FileAccessProperties::new().with_metadata_cache(MetadataCacheConfig::new(STRUCTURE));
    let root = ReadSeekSource::new(counted)
        .map_err(Error::from)
        .and_then(|source| File::from_source_with_options(source, options))
        .map_err(|error| reader.damaged(&error))?
        .root();
    reader.group(&root, "", 0)?;
    let series = reader.finish();
    if series.is_empty() {
        let message = "found no numeric array of two rows or more, expected readings";
        return Err(ReadError::new(file, Location::File, message));
    }
    Ok(Source {
        file: file.into(),
        format,
        series,
        notices: reader.notices,
    })
}

/// A file that reports how many bytes are read.
struct Counted {
    file: Opened,
    read: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.read.fetch_add(read as u64, Ordering::Relaxed);
        Ok(read)
    }
}

impl Seek for Counted {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}

struct Reader<'a> {
    file: &'a str,
    is_matlab: bool,
    /// Receives the number of bytes read.
    progress: Sender<u64>,
    /// Bytes read since the last report.
    read: Arc<AtomicU64>,
    /// Bytes of the file.
    bytes: u64,
    /// Remaining budget for decoded content (bytes).
    left: u64,
    /// Memory for decoded content.
    budget: &'a MemoryBudget,
    objects: usize,
    /// Series, each with the MATLAB variable to which it belongs.
    series: Vec<(String, Series)>,
    notices: Vec<String>,
}

/// Rows and columns of an array of readings.
#[derive(Clone, Copy)]
struct Size {
    rows: u64,
    columns: u64,
    /// Whether the array is stored in column-major order.
    by_columns: bool,
    /// Whether rows and columns are exchanged: the columns are the rows of the array.
    is_transposed: bool,
}

impl Size {
    /// The array with one row per channel in place of one column.
    fn transposed(self) -> Self {
        Self {
            rows: self.columns,
            columns: self.rows,
            by_columns: !self.by_columns,
            is_transposed: true,
        }
    }
}

/// A column of an array.
struct ColumnBuilder {
    name: String,
    unit: Option<String>,
    cells: Filling,
}

impl Reader<'_> {
    fn fail(&self, message: impl Into<String>) -> ReadError {
        ReadError::new(self.file, Location::File, message)
    }

    fn damaged(&self, error: &Error) -> ReadError {
        self.fail(match error {
            Error::FileMarkedInUse(_) => {
                "was not closed by the program that wrote it, expected a closed file; h5clear -s <file> clears the flag"
                    .to_owned()
            }
            // The address of a link by name is the largest number.
            Error::Format(FormatError::OffsetOverflow {
                offset: u64::MAX, ..
            }) => "is damaged or has links by name (soft or external links), expected HDF5 without them".to_owned(),
            Error::Format(FormatError::InvalidLayoutVersion(version)) => format!(
                "stores an array in layout version {version}, which is unknown here, expected version 3 or 4: convert it with h5repack --high=v114"
            ),
            error => format!("is damaged or of an unsupported version, expected HDF5 ({error})"),
        })
    }

    fn leave_out(&mut self, path: &str, why: &str) {
        let what = if self.is_matlab { "variable" } else { "array" };
        let notice = format!("{}, {what} {}: {why}, left out", self.file, quoted(path));
        self.notices.push(notice);
    }

    /// Reads the arrays of a group, and of the groups in it, by their names.
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), ReadError> {
        if depth > MAX_DEPTH {
            self.leave_out(path, "nested too deeply");
            return Ok(());
        }
        let datasets = group
            .iter_datasets()
            .map_err(|error| self.damaged(&error))?;
        let mut datasets: Vec<(String, Dataset)> = datasets.collect();
        let groups = group.iter_groups().map_err(|error| self.damaged(&error))?;
        let mut groups: Vec<(String, Group)> = groups.collect();
        self.objects += datasets.len() + groups.len();
        if self.objects > MAX_OBJECTS {
            let message =
                format!("found more than {MAX_OBJECTS} groups and arrays, expected fewer");
            return Err(self.fail(message));
        }
        datasets.sort_by(|a, b| a.0.cmp(&b.0));
        groups.sort_by(|a, b| a.0.cmp(&b.0));
        let below = |name: &str| match path {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        };
        let headings = self.headings(&datasets)?;
        for (name, dataset) in &datasets {
            let is_heading = name
                .strip_suffix("_items")
                .is_some_and(|block| headings.contains_key(&format!("{block}_values")));
            if !is_heading {
                self.dataset(dataset, &below(name), headings.get(name))?;
            }
        }
        for (name, group) in &groups {
            if self.is_matlab && name.starts_with('#') {
                continue;
            }
            if self.is_matlab && self.has(group.attrs(), "MATLAB_sparse")? {
                self.leave_out(&below(name), "sparse");
                continue;
            }
            let indexed = name.strip_prefix("_i_");
            if indexed.is_some_and(|table| datasets.iter().any(|(name, _)| name == table)) {
                self.leave_out(&below(name), "an index of PyTables");
                continue;
            }
            self.group(group, &below(name), depth + 1)?;
        }
        Ok(())
    }

    /// Whether an attribute of this name exists.
    fn has(
        &self,
        attributes: Result<HashMap<String, AttrValue>, Error>,
        name: &str,
    ) -> Result<bool, ReadError> {
        let attributes = attributes.map_err(|error| self.damaged(&error))?;
        Ok(attributes.contains_key(name))
    }

    /// The names of the columns of `block0_values`, which pandas keeps in `block0_items` beside it.
    fn headings(
        &self,
        datasets: &[(String, Dataset)],
    ) -> Result<HashMap<String, Vec<String>>, ReadError> {
        let mut headings = HashMap::new();
        for (name, items) in datasets {
            let Some(block) = name.strip_suffix("_items") else {
                continue;
            };
            let values = format!("{block}_values");
            let failed = |error| self.damaged(&error);
            let Some((_, of)) = datasets.iter().find(|(name, _)| *name == values) else {
                continue;
            };
            let (shape, columns) = (items.shape().map_err(failed)?, of.shape().map_err(failed)?);
            let is_text = matches!(
                items.datatype().map_err(failed)?,
                Datatype::String { size: ..=255, .. }
            );
            if is_text
                && shape.len() == 1
                && shape.first() == columns.get(1)
                && shape[0] <= MAX_COLUMNS
            {
                headings.insert(values, items.read_string().map_err(failed)?);
            }
        }
        Ok(headings)
    }

    /// Reads an array, if it holds readings.
    fn dataset(
        &mut self,
        dataset: &Dataset,
        path: &str,
        headings: Option<&Vec<String>>,
    ) -> Result<(), ReadError> {
        let shape = dataset.shape().map_err(|error| self.damaged(&error))?;
        let datatype = dataset.datatype().map_err(|error| self.damaged(&error))?;
        let attributes = dataset.attrs().map_err(|error| self.damaged(&error))?;
        if self.is_matlab
            && let Some(why) = not_numbers(&attributes)
        {
            self.leave_out(path, &why);
            return Ok(());
        }
        let mut fields = Vec::new();
        let mut strange = Vec::new();
        fields_of(&datatype, "", 0, &mut fields, &mut strange);
        for (name, why) in &strange {
            self.leave_out(&joined(path, name), why);
        }
        if fields.is_empty() {
            return Ok(());
        }
        let Some(mut size) = self.size(path, &shape) else {
            return Ok(());
        };
        let parts = parts_of(&fields);
        if size.columns > MAX_COLUMNS && size.rows <= MAX_CHANNELS && parts == 1 {
            size = size.transposed();
        }
        if size.columns.saturating_mul(parts as u64) > MAX_COLUMNS {
            let (rows, columns) = (size.rows, size.columns);
            let why = format!("{rows} x {columns} values, more than {MAX_COLUMNS} columns");
            self.leave_out(path, &why);
            return Ok(());
        }
        self.check(dataset, path, &shape)?;
        let mut columns = self.columns(path, size, &fields, &attributes, headings);
        self.fill(dataset, path, &shape, size, &fields, &mut columns)?;
        self.add(path, size, columns);
        Ok(())
    }

    /// Rows and columns of an array of readings; other arrays are reported in a notice.
    fn size(&mut self, path: &str, shape: &[u64]) -> Option<Size> {
        let (rows, columns, by_columns) = match *shape {
            [rows] => (rows, 1, false),
            [1, values] | [values, 1] => (values, 1, false),
            [columns, rows] if self.is_matlab => (rows, columns, true),
            [rows, columns] => (rows, columns, false),
            [] => {
                self.leave_out(path, "a single value");
                return None;
            }
            _ => {
                self.leave_out(path, "more than two dimensions");
                return None;
            }
        };
        if rows < 2 || columns == 0 {
            let why = format!("{rows} x {columns} values, not readings");
            self.leave_out(path, &why);
            return None;
        }
        Some(Size {
            rows,
            columns,
            by_columns,
            is_transposed: false,
        })
    }

    /// Refuses an array that this reader cannot decode, or that claims to hold more than the file can.
    fn check(&mut self, dataset: &Dataset, path: &str, shape: &[u64]) -> Result<(), ReadError> {
        let filters = dataset.filter_pipeline();
        let unread = filters.iter().find(|filter| !FILTERS.contains(&filter.id));
        let layout = dataset.layout().map_err(|error| self.damaged(&error))?;
        let what = match (&layout, unread) {
            (_, Some(filter)) => {
                let shown = filter.to_string();
                let name = quoted(shown.split('(').next().unwrap_or_default());
                format!(
                    "the filter {name} ({}), expected gzip, LZF or none",
                    filter.id
                )
            }
            (Layout::Virtual, _) => "parts of other arrays, expected values of its own".to_owned(),
            (
                Layout::Chunked {
                    index: ChunkIndex::BTreeV2,
                    ..
                },
                _,
            ) => "several extensible dimensions, expected one".to_owned(),
            _ => String::new(),
        };
        let path = quoted(path);
        if !what.is_empty() {
            return Err(self.fail(format!("array {path} uses {what}")));
        }
        // The crate allocates a chunk of the size that the file states before reading it.
        if dataset.is_chunked() {
            let pieces = dataset.chunks().map_err(|error| self.damaged(&error))?;
            let ends_in_file = pieces.iter().all(|piece| {
                let end = piece.address.checked_add(piece.storage_size);
                end.is_some_and(|end| end <= self.bytes)
            });
            if !ends_in_file {
                let message = format!("is damaged, array {path} has chunks beyond its end");
                return Err(self.fail(message));
            }
        }
        let of = |shape: &[u64]| {
            let element = dataset.element_size().ok();
            shape
                .iter()
                .try_fold(element?, |bytes, size| bytes.checked_mul(*size))
        };
        let piece = match &layout {
            Layout::Chunked { chunk_shape, .. } => of(chunk_shape),
            _ => Some(0),
        };
        match (of(shape), piece) {
            (Some(bytes), Some(piece)) if bytes.max(piece) <= self.left => {
                self.left -= bytes;
                Ok(())
            }
            _ => {
                let message = format!("array {path} claims more values than its file can hold");
                Err(self.fail(message))
            }
        }
    }

    fn columns(
        &self,
        path: &str,
        size: Size,
        fields: &[Field],
        attributes: &HashMap<String, AttrValue>,
        headings: Option<&Vec<String>>,
    ) -> Vec<ColumnBuilder> {
        let stated = |(name, _): &(&String, &AttrValue)| {
            ["unit", "units"].contains(&name.to_lowercase().as_str())
        };
        let units = attributes.iter().find(stated);
        let units = units
            .and_then(|(_, value)| value.as_strings())
            .unwrap_or_default();
        let parts = parts_of(fields);
        let total = size.columns as usize * parts;
        let mut columns = Vec::with_capacity(total);
        for number in 0..size.columns as usize {
            for field in fields {
                let count = size.columns as usize * field.count;
                for part in 0..field.count {
                    let number = number * field.count + part;
                    let (name, heading) = heading(path, &field.name);
                    let name = match headings.and_then(|names| names.get(number)) {
                        Some(heading) => heading.clone(),
                        None if count == 1 => name,
                        None if self.is_matlab && size.is_transposed => {
                            format!("{name}({},:)", number + 1)
                        }
                        None if self.is_matlab => format!("{name}(:,{})", number + 1),
                        None if size.is_transposed => format!("{name}[{number},:]"),
                        None => format!("{name}[{number}]"),
                    };
                    let stated = match units {
                        [unit] if fields.len() == 1 => Some(unit),
                        units if units.len() == total => units.get(columns.len()),
                        _ => None,
                    };
                    let stated = stated.map(|unit| bare(unit).to_owned());
                    columns.push(ColumnBuilder {
                        name,
                        unit: stated.filter(|unit| !unit.is_empty()).or(heading),
                        cells: match field.cell {
                            Cell::Text | Cell::FarText => Filling::Texts(FillingTexts::default()),
                            _ => Filling::Numbers(Vec::new()),
                        },
                    });
                }
            }
        }
        columns
    }

    /// Reads the values of an array into its columns.
    fn fill(
        &mut self,
        dataset: &Dataset,
        path: &str,
        shape: &[u64],
        size: Size,
        fields: &[Field],
        columns: &mut [ColumnBuilder],
    ) -> Result<(), ReadError> {
        let element = dataset
            .element_size()
            .map_err(|error| self.damaged(&error))?;
        let is_far = fields.iter().any(|field| field.cell == Cell::FarText);
        let cells = size.rows * size.columns;
        let (lines, line_cells) = match *shape {
            [lines, cells] => (lines, cells),
            _ => (cells, 1),
        };
        let line_bytes = line_cells.saturating_mul(element).max(1);
        let mut window = if is_far {
            (TEXTS / line_cells.max(1)).max(1)
        } else {
            (WINDOW / line_bytes).max(1)
        };
        // The window spans whole chunks, so that none is decoded twice.
        if let Ok(Some(piece)) = dataset.chunk_shape()
            && let Some(height) = piece.first().filter(|height| **height > 0)
            && !is_far
        {
            window = window.next_multiple_of(*height).min(lines);
        }
        let parts = parts_of(fields);
        // A byte may be a value, and each text may be another.
        let sizes = (fields.iter()).map(|field| field.size.max(size_of::<f64>()) * field.count);
        let cell_bytes = sizes.sum::<usize>() as u64;
        // The window, and a chunk that is decoded into it.
        let bytes = window
            .min(lines)
            .saturating_mul(line_bytes.saturating_mul(2));
        let taken = (self.budget.take(cells.saturating_mul(cell_bytes)))
            .and_then(|()| self.budget.temporary().take(bytes));
        taken.map_err(|over| self.fail(format!("array {} {over}", quoted(path))))?;
        let mut found = 0;
        for first in (0..lines).step_by(usize::try_from(window).unwrap_or(usize::MAX)) {
            // Maps each cell of a window to its column.
            let column = |k: u64| match size.by_columns {
                true => (found + k) / size.rows,
                false => (found + k) % size.columns,
            };
            let count;
            if is_far {
                let texts = dataset.read_string_rows(first, window);
                let texts = texts.map_err(|error| self.damaged(&error))?;
                count = texts.len() as u64;
                for (k, text) in (0..count).zip(&texts) {
                    if let Some(Filling::Texts(texts)) = cells_of(columns, column(k) as usize) {
                        texts.push(text);
                    }
                }
            } else {
                let bytes = dataset.read_raw_rows(first, window);
                let bytes = bytes.map_err(|error| self.damaged(&error))?;
                count = bytes.len() as u64 / element;
                for (k, bytes) in (0..count).zip(bytes.chunks_exact(element as usize)) {
                    add_cell(bytes, fields, columns, column(k) as usize * parts);
                }
            }
            found += count;
            let read = self.read.swap(0, Ordering::Relaxed);
            let sent = self.progress.send(read);
            sent.map_err(|_| self.fail("was not read to its end"))?;
        }
        if found == cells {
            return Ok(());
        }
        let path = quoted(path);
        Err(self.fail(format!("array {path} has {found} values, expected {cells}")))
    }

    /// Adds the columns of an array to the series of as many rows; in MATLAB, of the same variable.
    fn add(&mut self, path: &str, size: Size, columns: Vec<ColumnBuilder>) {
        let owner = match path.split_once('.') {
            Some((owner, _)) if self.is_matlab => owner,
            _ => "",
        };
        let rows = size.rows as usize;
        let known = |(of, series): &(String, Series)| of == owner && series.rows == rows;
        let place = self.series.iter().position(known).unwrap_or_else(|| {
            let series = Series {
                rows,
                ..Series::default()
            };
            self.series.push((owner.to_owned(), series));
            self.series.len() - 1
        });
        let series = &mut self.series[place].1;
        for ColumnBuilder { name, unit, cells } in columns {
            let place = format!("{}, array {}", self.file, quoted(&name));
            let added = series.add(name, unit, cells);
            let notice = |why| format!("{place}: {why}");
            self.notices.extend(added.err().map(notice));
        }
    }

    /// The series that have numbers, with names.
    fn finish(&mut self) -> Vec<Series> {
        let mut kept: Vec<Series> = Vec::new();
        for (_, mut series) in std::mem::take(&mut self.series) {
            if series.channels.is_empty() {
                for text in &series.texts {
                    let why = format!("{} texts without numbers beside them", series.rows);
                    self.leave_out(&text.name, &why);
                }
                continue;
            }
            series.name = match kept.len() {
                0 => stem(self.file),
                count => format!("{} ({})", stem(self.file), count + 1),
            };
            kept.push(series);
        }
        kept
    }
}

/// Number of columns for the fields of a record.
fn parts_of(fields: &[Field]) -> usize {
    let counts = fields.iter().map(|field| field.count);
    counts.fold(0, usize::saturating_add)
}

/// Adds an element of an array to the columns from index `place` on.
fn add_cell(bytes: &[u8], fields: &[Field], columns: &mut [ColumnBuilder], mut place: usize) {
    for field in fields {
        for part in 0..field.count {
            let at = field.offset + part * field.size;
            let bytes = bytes.get(at..at + field.size).unwrap_or_default();
            match cells_of(columns, place) {
                Some(Filling::Numbers(values)) => values.push(field.number(bytes)),
                Some(Filling::Texts(texts)) => texts.push(&text(bytes)),
                None => {}
            }
            place += 1;
        }
    }
}

fn cells_of(columns: &mut [ColumnBuilder], place: usize) -> Option<&mut Filling> {
    columns.get_mut(place).map(|column| &mut column.cells)
}

/// Describes a MATLAB variable that is not a numeric array.
fn not_numbers(attributes: &HashMap<String, AttrValue>) -> Option<String> {
    let class = attributes.get("MATLAB_class").and_then(AttrValue::as_str);
    if attributes.contains_key("MATLAB_empty") {
        return Some("empty".to_owned());
    }
    if attributes.contains_key("MATLAB_object_decode") {
        return Some(object(class.unwrap_or_default()));
    }
    let what = match class {
        Some("cell") => "cells (save with -v7)",
        Some("char") => "text",
        Some("function_handle") => "a function",
        _ => return None,
    };
    Some(what.to_owned())
}

/// The name of a column and the unit that its own part of the path states: a dot in the path is no mark of a unit.
fn heading(path: &str, field: &str) -> (String, Option<String>) {
    let whole = joined(path, field);
    match whole.rsplit_once('.') {
        Some((before, last)) => {
            let (name, unit) = split_heading(last);
            (joined(before, &name), unit)
        }
        None => split_heading(&whole),
    }
}
