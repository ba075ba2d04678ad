//! Cells to columns.

use tautline_files::{Location, ReadError, quoted};

use super::layout::Layout;
use crate::source::{Filling, FillingTexts, Series};
use crate::text::{Cells, Decimal, is_gap, parse_number, parse_timestamp};

/// Columns that are filled row by row.
pub(crate) struct Columns {
    file: String,
    columns: Vec<ColumnBuilder>,
    rows: usize,
    /// Rows with too few or too many cells: line and number of cells of the first one, and the number of such rows.
    broken: Option<(u64, usize, usize)>,
    /// Line of the last row.
    last_line: u64,
    /// Line of the first number with a decimal point, and with a decimal comma.
    decimals: [Option<u64>; 2],
}

struct ColumnBuilder {
    name: String,
    unit: Option<String>,
    cells: Filling,
    /// Whether the cells are dates and times of day, as numbers in seconds.
    is_time: bool,
    /// Cells that are not readings: line and text of the first one, and their number.
    not_read: Option<(u64, String, usize)>,
}

impl Columns {
    /// Columns of a layout; their types are determined from a sample of rows.
    pub fn new(file: &str, layout: &Layout, sample: &[(u64, &Cells)]) -> Self {
        let data = || {
            sample
                .iter()
                .filter(|(line, _)| *line >= layout.first_data_line)
                .map(|(_, cells)| *cells)
        };
        let column = |(k, (name, unit)): (usize, &(String, Option<String>))| {
            let (cells, is_time) = filling_like(data().map(|cells| cells.get(k)));
            ColumnBuilder {
                name: name.clone(),
                unit: if is_time {
                    Some("s".into())
                } else {
                    unit.clone()
                },
                cells,
                is_time,
                not_read: None,
            }
        };
        Self {
            file: file.into(),
            columns: layout.headings.iter().enumerate().map(column).collect(),
            rows: 0,
            broken: None,
            last_line: 0,
            decimals: [None; 2],
        }
    }

    /// Adds a row. Blank rows and comments are skipped; a row with a different number of cells is counted and left out.
    ///
    /// # Errors
    /// If some numbers have decimal points and others decimal commas: one of the two would be misread.
    pub fn push(&mut self, line: u64, cells: &Cells) -> Result<(), ReadError> {
        if cells.are_blank() || cells.get(0).starts_with(['#', '%']) {
            return Ok(());
        }
        self.last_line = line;
        let width = self.columns.len();
        // Some recorders end each row with a separator.
        let is_row =
            cells.len() == width || (cells.len() == width + 1 && cells.get(width).is_empty());
        if !is_row {
            let (_, _, count) = self.broken.get_or_insert((line, cells.len(), 0));
            *count += 1;
            return Ok(());
        }
        self.rows += 1;
        for (k, column) in self.columns.iter_mut().enumerate() {
            if let Some(decimal) = column.push(line, cells.get(k)) {
                let which = usize::from(decimal == Decimal::Comma);
                self.decimals[which].get_or_insert(line);
            }
        }
        if let [Some(point), Some(comma)] = self.decimals {
            let (this, other, where_else) = if line == point {
                ("point", "comma", comma)
            } else {
                ("comma", "point", point)
            };
            let message = format!(
                "found a decimal {this} and, in line {where_else}, a decimal {other}, expected one of the two"
            );
            return Err(ReadError::new(&self.file, Location::Line(line), message));
        }
        Ok(())
    }

    /// The series of these columns; cells that were not read are reported in notices.
    ///
    /// # Errors
    /// If there is no row, or most rows have a different number of cells.
    pub fn finish(self, name: &str, notices: &mut Vec<String>) -> Result<Series, ReadError> {
        let (file, width) = (&self.file, self.columns.len());
        if let Some((line, found, count)) = self.broken {
            if count > self.rows {
                let message =
                    format!("found {found} cells, expected {width} as in most of the first rows");
                return Err(ReadError::new(file, Location::Line(line), message));
            }
            notices.push(match (count, line == self.last_line) {
                (1, true) => format!("{file}, line {line}: the last row ends after {found} of {width} cells: left out"),
                (1, false) => format!("{file}, line {line}: found {found} cells, expected {width}: row left out"),
                _ => format!("{file}, line {line}: found {found} cells, expected {width}: {count} such rows left out"),
            });
        }
        if self.rows == 0 {
            return Err(super::no_numbers(file));
        }
        let mut series = Series {
            name: name.into(),
            rows: self.rows,
            ..Series::default()
        };
        for column in self.columns {
            let ColumnBuilder {
                name,
                unit,
                cells,
                not_read,
                ..
            } = column;
            let place = format!("{file}, column {}", quoted(&name));
            if let Some((line, text, count)) = not_read {
                let more = if count > 1 {
                    format!(" and {} more such cells", count - 1)
                } else {
                    String::new()
                };
                notices.push(format!(
                    "{place}: line {line} holds {}{more}, treated as missing",
                    quoted(&text)
                ));
            }
            let added = series.add(name, unit, cells);
            notices.extend(added.err().map(|why| format!("{place}: {why}")));
        }
        Ok(series)
    }
}

/// The type of column that matches most of these cells, and whether it has times.
fn filling_like<'a>(cells: impl Iterator<Item = &'a str> + Clone) -> (Filling, bool) {
    let filled: Vec<&str> = cells.filter(|cell| !is_gap(cell)).collect();
    let are_most = |is_read: fn(&str) -> bool| {
        let read = filled.iter().filter(|cell| is_read(cell)).count();
        read > 0 && read * 2 >= filled.len()
    };
    if are_most(|cell| parse_number(cell).is_some()) {
        (Filling::Numbers(Vec::new()), false)
    } else if are_most(|cell| parse_timestamp(cell).is_some()) {
        (Filling::Numbers(Vec::new()), true)
    } else {
        (Filling::Texts(FillingTexts::default()), false)
    }
}

impl ColumnBuilder {
    /// Adds a cell and returns the decimal separator of its number.
    fn push(&mut self, line: u64, cell: &str) -> Option<Decimal> {
        let mut decimal = None;
        let values = match &mut self.cells {
            Filling::Texts(texts) => {
                texts.push(cell);
                return None;
            }
            Filling::Numbers(values) => values,
        };
        let value = match self.is_time {
            true => parse_timestamp(cell),
            false => parse_number(cell).map(|(value, sign)| {
                decimal = Some(sign).filter(|sign| *sign != Decimal::None);
                value
            }),
        };
        if value.is_none() && !is_gap(cell) {
            let (_, _, count) = self.not_read.get_or_insert_with(|| (line, cell.into(), 0));
            *count += 1;
        }
        values.push(value.unwrap_or(f64::NAN));
        decimal
    }
}
