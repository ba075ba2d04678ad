//! Tables of any kind: rows of cells become channels. Text files, spreadsheets and exports share this.

mod columns;
mod layout;

use tautline_files::{Location, ReadError};

use crate::source::Series;
use crate::text::Cells;
pub(crate) use columns::Columns;
pub(crate) use layout::{Layout, make_unique};

/// Number of rows from which a layout is recognised.
pub(crate) const SAMPLE: usize = 200;

/// Converts rows of cells, each with its line number, to a series.
///
/// # Errors
/// If no row has numbers, or decimal points and commas are mixed.
pub(crate) fn read_rows(
    file: &str,
    name: &str,
    rows: &[(u64, Cells)],
    notices: &mut Vec<String>,
) -> Result<Series, ReadError> {
    let sample: Vec<(u64, &Cells)> = rows
        .iter()
        .take(SAMPLE)
        .map(|(line, cells)| (*line, cells))
        .collect();
    let layout = Layout::of(&sample).ok_or_else(|| no_numbers(file))?;
    layout.check(file)?;
    let mut columns = Columns::new(file, &layout, &sample);
    notices.extend(layout.notices(file));
    for (line, cells) in rows
        .iter()
        .filter(|(line, _)| *line >= layout.first_data_line)
    {
        columns.push(*line, cells)?;
    }
    columns.finish(name, notices)
}

/// The error that a table has no rows of numbers.
pub(crate) fn no_numbers(file: &str) -> ReadError {
    let message = "found no row of numbers, expected a table with a reading in each column";
    ReadError::new(file, Location::File, message)
}
