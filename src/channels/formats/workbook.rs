//! The archive of a workbook, and the series of its sheets.

use tautline_files::{Location, ReadError, quoted};

use super::archive::Archive;
use super::fault::Fault;
use super::{over_budget, stem};
use crate::memory::MemoryBudget;
use crate::source::{Format, Source};
use crate::table::read_rows;
use crate::text::Cells;

/// Maximum number of columns of a sheet, as in Excel and LibreOffice.
const MAX_COLUMNS: usize = 16_384;
/// Memory of a cell besides its text: its string, its range in the row, and the smallest block that the system allocates.
const CELL: usize = size_of::<String>() + size_of::<(usize, usize)>() + 32;

/// Memory of a row besides its cells, before and after it becomes one of a table.
const ROW: u64 = 2 * size_of::<(u64, Cells)>() as u64;

/// The archive of a workbook.
pub(super) struct Workbook<'a> {
    pub file: &'a str,
    pub archive: Archive<'a>,
    pub budget: &'a MemoryBudget,
}

impl Workbook<'_> {
    pub fn fail(&self, message: impl Into<String>) -> ReadError {
        ReadError::new(self.file, Location::File, message.into())
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

    /// The text of a part, whose memory is taken from `budget`; `None` if there is no such part.
    pub fn part(&self, name: &str, budget: &MemoryBudget) -> Result<Option<String>, ReadError> {
        let bytes = self.archive.read(name, budget);
        let Some(bytes) = bytes.map_err(|message| self.fail(message))? else {
            return Ok(None);
        };
        let text = String::from_utf8(bytes)
            .map_err(|_| self.fail(format!("part {name} is damaged, expected UTF-8")))?;
        Ok(Some(text))
    }

    /// The text of a part without which there is no workbook.
    pub fn expected_part(&self, name: &str) -> Result<String, ReadError> {
        self.part(name, self.budget)?
            .ok_or_else(|| self.damaged(name))
    }

    /// Collects the series of `count` sheets.
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
    /// Reason why the first sheet without a table was left out.
    refusal: Option<ReadError>,
}

impl Sheets<'_> {
    /// Reports a sheet without cells, such as a chart.
    pub fn leave_out(&mut self, name: &str) {
        let (file, name) = (self.book.file, quoted(name));
        let notice = format!("{file}: sheet {name} left out: it is not a table");
        self.source.notices.push(notice);
    }

    /// Adds a sheet of a part with its rows, of which only the series is kept.
    pub fn add(&mut self, name: &str, part: &str, grid: Grid) -> Result<(), ReadError> {
        let rows = grid.finish();
        let rows = rows.map_err(|fault| self.book.refused(part, fault))?;
        let Workbook { file, budget, .. } = self.book;
        let notices = &mut self.source.notices;
        let place = format!("{file}, sheet {}", quoted(name));
        if rows.is_empty() {
            notices.push(format!("{place}: empty"));
            return Ok(());
        }
        let title = match self.count {
            1 => stem(file),
            _ => format!("{} {name}", stem(file)),
        };
        match read_rows(&place, &title, &rows, notices) {
            Ok(series) => {
                let taken = budget.take(series.bytes());
                taken.map_err(|over| over_budget(file, over))?;
                self.source.series.push(series);
            }
            // A sheet of notes beside the readings is no reason to refuse them.
            Err(error) => {
                notices.push(format!("{error}: sheet left out"));
                self.refusal.get_or_insert(error);
            }
        }
        Ok(())
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

/// Rows of a sheet while they are read. Cells count, since a few bytes of a part may stand for many of them.
pub(super) struct Grid {
    budget: MemoryBudget,
    /// Cells of the current row.
    pub cells: Vec<String>,
    rows: Vec<(u64, Vec<String>)>,
}

impl Grid {
    pub fn new(budget: &MemoryBudget) -> Self {
        Self {
            budget: budget.clone(),
            cells: Vec::new(),
            rows: Vec::new(),
        }
    }

    /// Puts a text into `count` cells of the row; cells before them that were left out are empty.
    pub fn put(&mut self, column: usize, count: usize, text: String) -> Result<(), Fault> {
        let end = column.saturating_add(count);
        if end > MAX_COLUMNS {
            return Err(Fault::Damaged);
        }
        let width = end.max(self.cells.len());
        let added = width - self.cells.len();
        self.budget
            .take((added * CELL + count * text.len()) as u64)?;
        self.cells.resize(width, String::new());
        self.cells[column..end].fill(text);
        Ok(())
    }

    /// Ends a row that is there `count` times, with numbers from `first` on.
    pub fn end_row(&mut self, first: u64, count: u64) -> Result<(), Fault> {
        let cells = std::mem::take(&mut self.cells);
        let of_cells = cells.iter().map(|cell| CELL + cell.len()).sum::<usize>() as u64;
        // The cells of one row are counted already.
        let all = (ROW + of_cells).saturating_mul(count);
        self.budget.take(all - of_cells)?;
        let numbers = (0..count).map(|k| first.saturating_add(k));
        self.rows
            .extend(numbers.map(|number| (number, cells.clone())));
        Ok(())
    }

    /// The numbered rows as a table: without empty ones, and from the first of full width on all as wide as that.
    fn finish(self) -> Result<Vec<(u64, Cells)>, Fault> {
        let Self { budget, rows, .. } = self;
        let width = rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0);
        let filled = rows
            .into_iter()
            .filter(|(_, cells)| cells.iter().any(|cell| !cell.is_empty()));
        // Empty cells at the end of a row are not stored; titles may precede the table.
        let mut in_table = false;
        let padded = filled.map(|(number, mut cells)| {
            in_table |= cells.len() == width;
            if in_table {
                budget.take(((width - cells.len()) * CELL) as u64)?;
                cells.resize(width, String::new());
            }
            Ok((number, Cells::from_texts(&cells)))
        });
        padded.collect()
    }
}
