//! `poses.csv`: one row per measured pose.

mod assemble;
mod column;
mod columns;
mod plausible;

use std::io::{BufRead, Write};

use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;

use crate::error::{Loaded, Place, ReadError};
use crate::table::{Table, TableWriter};
pub(crate) use assemble::assemble;
pub(crate) use column::Column;
pub(crate) use columns::{Columns, Fault};
pub(crate) use plausible::{check_complete, check_plausible, unexplained};

/// Reads `poses.csv`; `file` is the name for messages.
///
/// # Errors
/// The first thing that makes the table unusable with this robot, with its line and column.
pub fn read_poses(
    reader: impl BufRead,
    file: &str,
    robot: &Robot,
) -> Result<Loaded<Measurements>, ReadError> {
    let mut table = Table::open(reader, file)?;
    let label_column = table.require(LABEL)?;
    let mut columns = Columns::default();
    let mut notices = Vec::new();
    // For every column of numbers or text its index in the file.
    let (mut number_cells, mut text_cells) = (Vec::new(), Vec::new());
    for (cell, name) in table.names().iter().enumerate() {
        if let Some(column) = Column::parse(name) {
            number_cells.push(cell);
            columns.numbers.push((column, Vec::new()));
        } else if cell != label_column {
            text_cells.push(cell);
            columns.other.push((name.clone(), Vec::new()));
            notices.push(table.unknown_column(name, "kept"));
        }
    }
    columns
        .check_header(robot)
        .map_err(|fault| table.header_error(&fault.column, fault.message))?;
    let mut lines = Vec::new();
    while let Some(row) = table.next_row()? {
        lines.push(row.line());
        columns.labels.push(row.integer(label_column)?);
        for (cell, (_, values)) in number_cells.iter().zip(&mut columns.numbers) {
            values.push(row.number(*cell)?);
        }
        for (cell, (_, texts)) in text_cells.iter().zip(&mut columns.other) {
            texts.push(row.text(*cell).to_string());
        }
    }
    let measurements = assemble(columns, robot)
        .and_then(|measurements| {
            check_plausible(&measurements, robot)?;
            check_complete(&measurements, robot)?;
            Ok(measurements)
        })
        .map_err(|fault| place_fault(fault, file, &lines))?;
    notices.extend(unexplained(&measurements, robot).map(|text| format!("{file}: {text}")));
    Ok(Loaded {
        value: measurements,
        notices,
    })
}

/// Name of the column with the labels.
pub(crate) const LABEL: &str = "pose";

fn place_fault(fault: Fault, file: &str, lines: &[u64]) -> ReadError {
    let line = |row: usize| lines.get(row).copied().unwrap_or_default();
    let place = fault
        .row
        .map_or(Place::File, |row| Place::Cell(line(row), fault.column));
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
    names.extend(columns.numbers.iter().map(|(column, _)| column.name()));
    names.extend(columns.other.iter().map(|(name, _)| name.clone()));
    let mut table = TableWriter::new(out, &names)?;
    for (row, label) in columns.labels.iter().enumerate() {
        table.integer(*label)?;
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
