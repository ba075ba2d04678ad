//! `poses.csv`: one row per measured pose.

mod assemble;
mod column;
mod columns;
mod plausible;

use std::io::{BufRead, Write};

use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;
use tautline_files::{Location, ReadError};

use crate::error::Loaded;
use crate::table::{Table, TableRow, TableWriter};
pub(crate) use column::{Group, PoseColumn};
pub(crate) use columns::{Columns, Fault};
pub(crate) use plausible::check_plausible;
use plausible::{check_home, unused_readings};

/// Lines of a `poses.csv` that was read, for messages about its rows.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PoseLines {
    /// The file as the operator named it.
    pub file: String,
    /// Line of each row.
    pub lines: Vec<u64>,
}

impl PoseLines {
    /// An error in a cell.
    #[must_use]
    pub fn error(&self, row: usize, column: &str, message: &str) -> ReadError {
        let fault = Fault::new(Some(row), column, message);
        place_fault(fault, &self.file, &self.lines)
    }
}

/// Reads `poses.csv`; `file` is the name for messages.
///
/// # Errors
/// The first error that makes the table unusable with this robot, with its line and column.
pub fn read_poses(
    reader: impl BufRead,
    file: &str,
    robot: &Robot,
) -> Result<Loaded<Measurements>, ReadError> {
    Ok(read_poses_and_lines(reader, file, robot)?.map(|(measurements, _)| measurements))
}

/// As [`read_poses`], with the line of each row.
pub(crate) fn read_poses_and_lines(
    reader: impl BufRead,
    file: &str,
    robot: &Robot,
) -> Result<Loaded<(Measurements, PoseLines)>, ReadError> {
    let mut table = Table::open(reader, file)?;
    let (places, mut columns) = read_header(&table, robot)?;
    let mut notices: Vec<String> = columns
        .other
        .iter()
        .map(|(name, _)| table.unknown_column(name, "kept"))
        .collect();
    let mut lines = Vec::new();
    while let Some(row) = table.next_row()? {
        lines.push(row.line());
        columns.add_row(&row, &places)?;
    }
    let measurements = columns
        .into_measurements(robot)
        .and_then(|measurements| check_home(&measurements, robot).map(|()| measurements))
        .map_err(|fault| place_fault(fault, file, &lines))?;
    let unused = unused_readings(&measurements, robot).into_iter();
    notices.extend(unused.map(|text| format!("{file}: {text}")));
    let file = file.to_owned();
    Ok(Loaded {
        value: (measurements, PoseLines { file, lines }),
        notices,
    })
}

/// Measured poses as named columns of equal length.
#[derive(Debug, Default)]
pub struct PoseColumns {
    /// Labels of the poses.
    pub labels: Vec<i64>,
    /// Group labels; empty if there are none.
    pub groups: Vec<String>,
    /// Numeric columns; NaN means not measured.
    pub numbers: Vec<(String, Vec<f64>)>,
    /// Text columns.
    pub texts: Vec<(String, Vec<String>)>,
}

/// The columns of measurements in `poses.csv`.
#[must_use]
pub fn pose_columns(measurements: &Measurements) -> PoseColumns {
    let columns = Columns::of(measurements);
    let numbers = columns.numbers.into_iter();
    PoseColumns {
        labels: columns.labels,
        groups: columns.groups,
        numbers: numbers
            .map(|(column, values)| (column.name(), values))
            .collect(),
        texts: columns.other,
    }
}

/// Indices in the file of the labels and of every numeric and text column.
struct Places {
    label: usize,
    group: Option<usize>,
    numbers: Vec<usize>,
    other: Vec<usize>,
}

impl Columns {
    /// Adds a row of a table.
    fn add_row(&mut self, row: &TableRow<'_>, places: &Places) -> Result<(), ReadError> {
        self.labels.push(row.integer(places.label)?);
        if let Some(cell) = places.group {
            self.groups.push(row.text(cell).to_string());
        }
        for (cell, (_, values)) in places.numbers.iter().zip(&mut self.numbers) {
            values.push(row.number(*cell)?);
        }
        for (cell, (_, texts)) in places.other.iter().zip(&mut self.other) {
            texts.push(row.text(*cell).to_string());
        }
        Ok(())
    }
}

/// Finds the columns; reads no rows.
fn read_header<R: BufRead>(
    table: &Table<R>,
    robot: &Robot,
) -> Result<(Places, Columns), ReadError> {
    let mut columns = Columns::default();
    let mut places = Places {
        label: table.require(LABEL)?,
        group: table.find(GROUP),
        numbers: Vec::new(),
        other: Vec::new(),
    };
    for (cell, name) in table.names().iter().enumerate() {
        if let Some(column) = PoseColumn::parse(name) {
            places.numbers.push(cell);
            columns.numbers.push((column, Vec::new()));
        } else if cell != places.label && Some(cell) != places.group {
            places.other.push(cell);
            columns.other.push((name.clone(), Vec::new()));
        }
    }
    columns
        .check_header(robot)
        .map_err(|fault| table.header_error(&fault.column, fault.message))?;
    Ok((places, columns))
}

/// Name of the column with the labels.
pub(crate) const LABEL: &str = "pose";
/// Name of the column with the group labels.
pub(crate) const GROUP: &str = "group";

/// Converts a fault in a table whose rows start at the given lines.
pub(crate) fn place_fault(fault: Fault, file: &str, lines: &[u64]) -> ReadError {
    let line = |row: usize| lines.get(row).copied().unwrap_or_default();
    let place = fault.row.map_or(Location::File, |row| {
        Location::Cell(line(row), fault.column)
    });
    let message = match fault.earlier_row {
        Some(row) => format!("{} (line {})", fault.message, line(row)),
        None => fault.message,
    };
    ReadError::new(file, place, message)
}

/// Writes `poses.csv`, so that it reads back bit by bit.
///
/// # Errors
/// If the writer fails.
pub fn write_poses(out: impl Write, measurements: &Measurements) -> std::io::Result<()> {
    let columns = Columns::of(measurements);
    let mut names = vec![LABEL.to_string()];
    names.extend((!columns.groups.is_empty()).then(|| GROUP.to_string()));
    names.extend(columns.numbers.iter().map(|(column, _)| column.name()));
    names.extend(columns.other.iter().map(|(name, _)| name.clone()));
    let mut table = TableWriter::new(out, &names)?;
    for (row, label) in columns.labels.iter().enumerate() {
        table.integer(*label)?;
        if let Some(group) = columns.groups.get(row) {
            table.text(group)?;
        }
        for (_, values) in &columns.numbers {
            table.number(values[row])?;
        }
        for (_, texts) in &columns.other {
            table.text(&texts[row])?;
        }
        table.end_row()?;
    }
    table.finish()
}

#[cfg(test)]
mod tests;
