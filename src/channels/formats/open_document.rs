//! Spreadsheets of LibreOffice and others (`.ods`): one part with all sheets, in which equal cells and rows that follow each other
//! are written once.
//!
//! Source: OASIS, Open Document Format for Office Applications 1.3, part 3, chapters 9 and 19.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use tautline_files::ReadError;

use super::fault::Fault;
use super::workbook::{Grid, Workbook};
use super::workbook_xml::{add_text, attribute, for_each_tag};
use crate::memory::MemoryBudget;
use crate::source::{Format, Source};

/// The part with all sheets.
pub(super) const CONTENT: &str = "content.xml";
/// The part that says which others are encrypted.
const MANIFEST: &str = "META-INF/manifest.xml";

pub(super) fn read(archive: &Workbook<'_>) -> Result<Source, ReadError> {
    let manifest = archive.part(MANIFEST, archive.budget)?.unwrap_or_default();
    if manifest.contains("encryption-data") {
        return Err(archive.fail("is encrypted, expected a workbook without a password"));
    }
    let text = archive.expected_part(CONTENT)?;
    let kind = kind(&text).ok_or_else(|| archive.damaged(CONTENT))?;
    if !kind.is_spreadsheet {
        let message = "is a document without a spreadsheet, expected .ods, .xlsx or .npz";
        return Err(archive.fail(message));
    }
    let mut found = archive.sheets(Format::OpenDocument, kind.sheets);
    let mut sheets = SheetReader(Reader::from_str(&text));
    loop {
        let sheet = sheets.next_sheet(&archive.budget.temporary());
        match sheet.map_err(|fault| archive.refused(CONTENT, fault))? {
            Some((name, grid)) => found.add(&name, CONTENT, grid)?,
            None => return found.finish(),
        }
    }
}

/// Type of the document and number of its sheets.
struct DocumentType {
    is_spreadsheet: bool,
    sheets: usize,
}

/// `None` if it is not XML.
fn kind(text: &str) -> Option<DocumentType> {
    let mut kind = DocumentType {
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

/// Reads one sheet after the other.
struct SheetReader<'a>(Reader<&'a [u8]>);

impl SheetReader<'_> {
    /// Name and rows of the next sheet; `None` after the last one.
    fn next_sheet(&mut self, budget: &MemoryBudget) -> Result<Option<(String, Grid)>, Fault> {
        loop {
            match self.0.read_event().map_err(|_| Fault::Damaged)? {
                // Of changes that are tracked, former cells are written first.
                Event::Start(tag) if is_aside(&tag) => self.skip(&tag)?,
                Event::Start(tag) if tag.local_name().as_ref() == b"table" => {
                    let name = attribute(&tag, "name").unwrap_or_default();
                    return Ok(Some((name, self.rows(budget)?)));
                }
                Event::Eof => return Ok(None),
                _ => {}
            }
        }
    }

    /// The rows until the end of a sheet with their numbers.
    fn rows(&mut self, budget: &MemoryBudget) -> Result<Grid, Fault> {
        let (mut grid, mut column) = (Grid::new(budget), 0);
        let (mut number, mut repeated) = (1_u64, 1_u64);
        let mut cell = Cell::default();
        loop {
            match self.0.read_event().map_err(|_| Fault::Damaged)? {
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
                    b"table-cell" | b"covered-table-cell" => {
                        Cell::of(&tag)?.put(&mut grid, &mut column)?;
                    }
                    name => cell.add_blank(name),
                },
                Event::End(tag) => match tag.local_name().as_ref() {
                    b"p" => cell.in_paragraph = false,
                    b"table-cell" | b"covered-table-cell" => {
                        std::mem::take(&mut cell).put(&mut grid, &mut column)?;
                    }
                    b"table-row" => {
                        // Rows without a value may be a million at the end of a sheet.
                        if !grid.cells.is_empty() {
                            grid.end_row(number, repeated)?;
                        }
                        (number, column) = (number + repeated, 0);
                    }
                    b"table" => return Ok(grid),
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

    /// Skips the content of a tag.
    fn skip(&mut self, tag: &BytesStart<'_>) -> Result<(), Fault> {
        let skipped = self.0.read_to_end(tag.name());
        skipped.map(|_| ()).map_err(|_| Fault::Damaged)
    }
}

/// Whether a tag holds texts other than those of cells: comments, drawings and tracked changes.
fn is_aside(tag: &BytesStart<'_>) -> bool {
    let name = tag.local_name();
    [&b"annotation"[..], b"shapes", b"frame", b"tracked-changes"].contains(&name.as_ref())
}

/// Number of repetitions of a cell or row.
fn times(tag: &BytesStart<'_>, name: &str) -> Result<u64, Fault> {
    let Some(count) = attribute(tag, name) else {
        return Ok(1);
    };
    let count: u32 = count.parse().map_err(|_| Fault::Damaged)?;
    Ok(u64::from(count).max(1))
}

/// A cell that is being read.
#[derive(Default)]
struct Cell {
    repeated: usize,
    /// Value of the attribute; `None` if the text of the cell is its value.
    value: Option<String>,
    /// Whether the cell has no value: an error of its formula, or a merged cell covers it.
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

    /// Adds it to a row as often as it is repeated; empty ones only before one with a value.
    fn put(self, grid: &mut Grid, column: &mut usize) -> Result<(), Fault> {
        let shown = self.value.unwrap_or(self.text);
        if !(self.is_void || shown.is_empty()) {
            grid.put(*column, self.repeated, shown)?;
        }
        *column = column.saturating_add(self.repeated);
        Ok(())
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
