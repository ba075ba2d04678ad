//! The archive of a workbook, and what its sheets become.

use tautline_session::{Place, ReadError, quoted};

use super::archive::Archive;
use super::fault::Fault;
use super::{over_budget, stem};
use crate::memory::{Lease, MemoryBudget};
use crate::source::{Format, Source};
use crate::table::read_rows;
use crate::text::Cells;

/// Maximum number of columns of a sheet, as in Excel and LibreOffice.
pub(super) const MAX_COLUMNS: usize = 16_384;
/// Maximum number of cells, including empty ones in between.
pub(super) const MAX_CELLS: usize = 50_000_000;
/// Memory of a cell besides its text: its string, its range in the row, and the smallest block that the system allocates.
pub(super) const CELL: usize = size_of::<String>() + size_of::<(usize, usize)>() + 32;

/// The archive of a workbook.
pub(super) struct Workbook<'a> {
    pub file: &'a str,
    pub archive: Archive<'a>,
    pub budget: &'a MemoryBudget,
}

impl Workbook<'_> {
    pub fn fail(&self, message: impl Into<String>) -> ReadError {
        ReadError::new(self.file, Place::File, message.into())
    }

    pub fn damaged(&self, part: &str) -> ReadError {
        self.fail(format!("part {part} is damaged, expected XML"))
    }

    pub fn refused(&self, part: &str, fault: Fault) -> ReadError {
        match fault {
            Fault::Damaged => self.damaged(part),
            Fault::Large(over) => self.fail(format!("part {part} {over}")),
        }
    }

    pub fn has(&self, part: &str) -> bool {
        self.archive.names().iter().any(|name| name == part)
    }

    /// A lease of nothing yet.
    pub fn lease(&self) -> Result<Lease, ReadError> {
        let lease = self.budget.lease(0);
        lease.map_err(|over| over_budget(self.file, over))
    }

    /// The text of a part, whose memory is added to a lease; `None` if there is no such part.
    pub fn part(&self, name: &str, memory: &mut Lease) -> Result<Option<String>, ReadError> {
        let bytes = self.archive.read(name, memory);
        let Some(bytes) = bytes.map_err(|message| self.fail(message))? else {
            return Ok(None);
        };
        let text = String::from_utf8(bytes)
            .map_err(|_| self.fail(format!("part {name} is damaged, expected UTF-8")))?;
        Ok(Some(text))
    }

    /// The text of a part without which there is no workbook.
    pub fn expected_part(&self, name: &str, memory: &mut Lease) -> Result<String, ReadError> {
        self.part(name, memory)?.ok_or_else(|| self.damaged(name))
    }

    /// What so many sheets become.
    pub fn sheets(&self, format: Format, count: usize) -> Sheets<'_> {
        Sheets {
            book: self,
            count,
            source: Source {
                file: self.file.into(),
                format,
                series: Vec::new(),
                notices: Vec::new(),
            },
            refusal: None,
        }
    }
}

/// Series of the sheets so far.
pub(super) struct Sheets<'a> {
    book: &'a Workbook<'a>,
    count: usize,
    source: Source,
    /// Why the first sheet without a table was left out.
    refusal: Option<ReadError>,
}

impl Sheets<'_> {
    /// A sheet that has no cells, such as a chart.
    pub fn leave_out(&mut self, name: &str) {
        let (file, name) = (self.book.file, quoted(name));
        let notice = format!("{file}: sheet {name} left out: it is not a table");
        self.source.notices.push(notice);
    }

    /// A sheet with its numbered rows.
    pub fn add(&mut self, name: &str, rows: &[(u64, Cells)]) {
        let Workbook { file, budget, .. } = self.book;
        let notices = &mut self.source.notices;
        let place = format!("{file}, sheet {}", quoted(name));
        if rows.is_empty() {
            notices.push(format!("{place}: empty"));
            return;
        }
        let title = match self.count {
            1 => stem(file),
            _ => format!("{} {name}", stem(file)),
        };
        match read_rows(&place, &title, rows, budget, notices) {
            Ok(series) => self.source.series.push(series),
            // A sheet of notes beside the readings is no reason to refuse them.
            Err(error) => {
                notices.push(format!("{error}: sheet left out"));
                self.refusal.get_or_insert(error);
            }
        }
    }

    pub fn finish(self) -> Result<Source, ReadError> {
        match (self.source.series.is_empty(), self.refusal) {
            (false, _) => Ok(self.source),
            (true, Some(refusal)) => Err(refusal),
            (true, None) => {
                let message = "found empty sheets only, expected readings";
                Err(self.book.fail(message))
            }
        }
    }
}

/// Numbered rows as a table: without empty ones, and from the first of full width on all as wide as that. The memory of cells
/// that are added is added to the lease.
pub(super) fn padded(
    rows: Vec<(u64, Vec<String>)>,
    memory: &mut Lease,
) -> Result<Vec<(u64, Cells)>, Fault> {
    let width = rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0);
    let filled = rows
        .into_iter()
        .filter(|(_, cells)| cells.iter().any(|cell| !cell.is_empty()));
    // Empty cells at the end of a row are not stored; titles may precede the table.
    let mut in_table = false;
    let padded = filled.map(|(number, mut cells)| {
        in_table |= cells.len() == width;
        if in_table {
            memory.take(((width - cells.len()) * CELL) as u64)?;
            cells.resize(width, String::new());
        }
        Ok((number, Cells::from_texts(&cells)))
    });
    padded.collect()
}
