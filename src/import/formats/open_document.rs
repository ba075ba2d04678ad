//! Spreadsheets of LibreOffice and others (`.ods`): one part with all sheets, in which equal cells and rows that follow each other
//! are written once.
//!
//! Source: OASIS, Open Document Format for Office Applications 1.3, part 3, chapters 9 and 19.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use tautline_session::ReadError;

use super::fault::Fault;
use super::workbook::{CELL, MAX_CELLS, MAX_COLUMNS, Workbook, padded};
use super::workbook_xml::{add_text, attribute, for_each_tag};
use crate::memory::Lease;
use crate::source::{Format, Source};
use crate::text::Cells;

/// The part with all sheets.
pub(super) const CONTENT: &str = "content.xml";
/// The part that says which others are encrypted.
const MANIFEST: &str = "META-INF/manifest.xml";

pub(super) fn read(archive: &Workbook<'_>) -> Result<Source, ReadError> {
    let mut book = archive.lease()?;
    let manifest = archive.part(MANIFEST, &mut book)?.unwrap_or_default();
    if manifest.contains("encryption-data") {
        return Err(archive.fail("is encrypted, expected a workbook without a password"));
    }
    let text = archive.expected_part(CONTENT, &mut book)?;
    let kind = kind(&text).ok_or_else(|| archive.damaged(CONTENT))?;
    if !kind.is_spreadsheet {
        let message = "is a document without a spreadsheet, expected .ods, .xlsx or .npz";
        return Err(archive.fail(message));
    }
    let mut found = archive.sheets(Format::OpenDocument, kind.sheets);
    let mut sheets = SheetReader {
        reader: Reader::from_str(&text),
        cells: 0,
    };
    loop {
        // Of a sheet only its series is kept.
        let mut memory = archive.lease()?;
        let sheet = sheets.next_sheet(&mut memory);
        match sheet.map_err(|fault| archive.refused(CONTENT, fault))? {
            Some(sheet) => found.add(&sheet.name, &sheet.rows),
            None => return found.finish(),
        }
    }
}

/// What the content is.
struct Kind {
    is_spreadsheet: bool,
    sheets: usize,
}

/// `None` if it is not XML.
fn kind(text: &str) -> Option<Kind> {
    let mut kind = Kind {
        is_spreadsheet: false,
        sheets: 0,
    };
    for_each_tag(text, |tag| match tag.local_name().as_ref() {
        b"spreadsheet" => kind.is_spreadsheet = true,
        b"table" => kind.sheets += 1,
        _ => {}
    })?;
    Some(kind)
}

/// A sheet with its numbered rows.
struct Sheet {
    name: String,
    rows: Vec<(u64, Cells)>,
}

/// Reads one sheet after the other.
struct SheetReader<'a> {
    reader: Reader<&'a [u8]>,
    /// Number of cells so far, including empty ones in between.
    cells: usize,
}

impl SheetReader<'_> {
    /// The next sheet, whose memory is added to the lease; `None` after the last one.
    fn next_sheet(&mut self, memory: &mut Lease) -> Result<Option<Sheet>, Fault> {
        loop {
            match self.reader.read_event().map_err(|_| Fault::Damaged)? {
                // Of changes that are tracked, former cells are written first.
                Event::Start(tag) if is_aside(&tag) => self.skip(&tag)?,
                Event::Start(tag) if tag.local_name().as_ref() == b"table" => {
                    let name = attribute(&tag, "name").unwrap_or_default();
                    let rows = self.rows(memory)?;
                    let rows = padded(rows, memory)?;
                    return Ok(Some(Sheet { name, rows }));
                }
                Event::Eof => return Ok(None),
                _ => {}
            }
        }
    }

    /// The rows until the end of a sheet with their numbers.
    fn rows(&mut self, memory: &mut Lease) -> Result<Vec<(u64, Vec<String>)>, Fault> {
        let mut rows = Vec::new();
        let (mut number, mut repeated) = (1_u64, 1_u64);
        let mut row = Row::default();
        let mut cell = Cell::default();
        loop {
            match self.reader.read_event().map_err(|_| Fault::Damaged)? {
                Event::Start(tag) if is_aside(&tag) => self.skip(&tag)?,
                Event::Start(tag) => match tag.local_name().as_ref() {
                    // A table in a cell is no part of the sheet.
                    b"table" => self.skip(&tag)?,
                    b"table-row" => repeated = times(&tag, "number-rows-repeated")?,
                    b"table-cell" | b"covered-table-cell" => cell = Cell::of(&tag)?,
                    b"p" => cell.begin_paragraph(),
                    name => cell.add_blank(name),
                },
                Event::Empty(tag) => match tag.local_name().as_ref() {
                    b"table-row" => number += times(&tag, "number-rows-repeated")?,
                    b"table-cell" | b"covered-table-cell" => row.push(&Cell::of(&tag)?, memory)?,
                    name => cell.add_blank(name),
                },
                Event::End(tag) => match tag.local_name().as_ref() {
                    b"p" => cell.in_paragraph = false,
                    b"table-cell" | b"covered-table-cell" => {
                        row.push(&std::mem::take(&mut cell), memory)?;
                    }
                    b"table-row" => {
                        let cells = std::mem::take(&mut row).cells;
                        if !cells.is_empty() {
                            self.repeat(&cells, (number, repeated), &mut rows, memory)?;
                        }
                        number += repeated;
                    }
                    b"table" => return Ok(rows),
                    _ => {}
                },
                Event::Eof => return Err(Fault::Damaged),
                event => {
                    let wanted = cell.in_paragraph;
                    add_text(&event, wanted, &mut cell.text).ok_or(Fault::Damaged)?;
                }
            }
        }
    }

    /// Skips what is in a tag.
    fn skip(&mut self, tag: &BytesStart<'_>) -> Result<(), Fault> {
        let skipped = self.reader.read_to_end(tag.name());
        skipped.map(|_| ()).map_err(|_| Fault::Damaged)
    }

    /// Adds a row as often as it is repeated, from a number on.
    fn repeat(
        &mut self,
        cells: &[String],
        (number, repeated): (u64, u64),
        rows: &mut Vec<(u64, Vec<String>)>,
        memory: &mut Lease,
    ) -> Result<(), Fault> {
        let texts: usize = cells.iter().map(String::len).sum();
        for number in number..number + repeated {
            self.cells += cells.len();
            if self.cells > MAX_CELLS {
                return Err(Fault::Damaged);
            }
            memory.take((cells.len() * CELL + texts) as u64)?;
            memory.take_values::<(u64, Cells)>(2)?;
            rows.push((number, cells.to_vec()));
        }
        Ok(())
    }
}

/// Whether a tag holds texts that are not those of cells: comments, drawings and former values.
fn is_aside(tag: &BytesStart<'_>) -> bool {
    let name = tag.local_name();
    [&b"annotation"[..], b"shapes", b"frame", b"tracked-changes"].contains(&name.as_ref())
}

/// How often a cell or row is there.
fn times(tag: &BytesStart<'_>, name: &str) -> Result<u64, Fault> {
    let Some(count) = attribute(tag, name) else {
        return Ok(1);
    };
    let count: u32 = count.parse().map_err(|_| Fault::Damaged)?;
    Ok(u64::from(count).max(1))
}

/// A row that is being read.
#[derive(Default)]
struct Row {
    cells: Vec<String>,
    /// Empty cells since the last one with a value.
    empty: usize,
}

impl Row {
    /// Adds a cell as often as it is repeated; empty ones only before one with a value.
    fn push(&mut self, cell: &Cell, memory: &mut Lease) -> Result<(), Fault> {
        let shown = cell.shown();
        if shown.is_empty() {
            self.empty = self.empty.saturating_add(cell.repeated);
            return Ok(());
        }
        let width = (self.cells.len().saturating_add(self.empty)).saturating_add(cell.repeated);
        if width > MAX_COLUMNS {
            return Err(Fault::Damaged);
        }
        let added = width - self.cells.len();
        memory.take((added * CELL + cell.repeated * shown.len()) as u64)?;
        self.cells.resize(width - cell.repeated, String::new());
        self.cells.resize(width, shown);
        self.empty = 0;
        Ok(())
    }
}

/// A cell that is being read.
#[derive(Default)]
struct Cell {
    repeated: usize,
    /// Its value; `None` if that is its text.
    value: Option<String>,
    /// Whether a formula has no value, or another cell covers it.
    is_void: bool,
    text: String,
    in_paragraph: bool,
}

impl Cell {
    fn of(tag: &BytesStart<'_>) -> Result<Self, Fault> {
        let mut cell = Self {
            repeated: usize::try_from(times(tag, "number-columns-repeated")?)
                .map_err(|_| Fault::Damaged)?,
            is_void: tag.local_name().as_ref() == b"covered-table-cell",
            ..Self::default()
        };
        for found in tag.attributes().flatten() {
            // LibreOffice states errors beside the kind of the standard, in its own namespace.
            let is_kind = found.key.local_name().as_ref() == b"value-type";
            cell.is_void |= is_kind && found.value.as_ref() == b"error";
        }
        cell.value = attribute(tag, "value")
            .or_else(|| attribute(tag, "date-value").map(|date| date.replace('T', " ")))
            .or_else(|| attribute(tag, "time-value").map(|time| clock(&time).unwrap_or(time)))
            .or_else(|| attribute(tag, "boolean-value").map(|is| truth(&is)))
            .or_else(|| attribute(tag, "string-value"));
        Ok(cell)
    }

    fn begin_paragraph(&mut self) {
        if !self.text.is_empty() {
            self.text.push(' ');
        }
        self.in_paragraph = true;
    }

    /// Adds a blank for those that have tags of their own, once however many there are.
    fn add_blank(&mut self, tag: &[u8]) {
        if self.in_paragraph && [&b"s"[..], b"tab", b"line-break"].contains(&tag) {
            self.text.push(' ');
        }
    }

    fn shown(&self) -> String {
        match (self.is_void, &self.value) {
            (true, _) => String::new(),
            (false, Some(value)) => value.clone(),
            (false, None) => self.text.clone(),
        }
    }
}

/// A truth value as Excel stores it.
fn truth(value: &str) -> String {
    match value {
        "true" => "1".to_owned(),
        _ => "0".to_owned(),
    }
}

/// `12:30:05.25` of `PT12H30M05.25S`.
fn clock(duration: &str) -> Option<String> {
    let (hours, rest) = duration.strip_prefix("PT")?.split_once('H')?;
    let (minutes, rest) = rest.split_once('M')?;
    let seconds = rest.strip_suffix('S')?.replace(',', ".");
    let is_number = |part: &str| part.parse::<f64>().is_ok();
    let all = [hours, minutes, &seconds].into_iter().all(is_number);
    all.then(|| format!("{hours}:{minutes}:{seconds}"))
}
