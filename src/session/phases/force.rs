//! `force.csv`: readings of a force sensor under known loads.

use std::io::{BufRead, Result as IoResult, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::Robot;
use tautline_files::ReadError;

use super::{cable, read_rows};
use crate::error::Loaded;
use crate::table::{Table, TableWriter};

/// One calibration pair of a force sensor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForcePair {
    /// Index of the cable, from 0.
    pub cable: usize,
    /// Raw reading (N).
    pub reading_n: f64,
    /// Known load, the tension of the cable (N).
    pub load_n: f64,
}

const COLUMNS: [&str; 3] = ["cable", "reading_n", "load_n"];

/// Reads `force.csv`; `file` is the name for messages.
///
/// # Errors
/// The first invalid row.
pub fn read_force(
    reader: impl BufRead,
    file: &str,
    robot: &Robot,
) -> Result<Loaded<Vec<ForcePair>>, ReadError> {
    let table = Table::open(reader, file)?;
    let [name, reading, load] = table.require_all(COLUMNS)?;
    read_rows(table, &COLUMNS, |row| {
        Ok(ForcePair {
            cable: cable(row, name, robot)?,
            reading_n: row.required(reading)?,
            load_n: row.required_if(load, |value| value >= 0.0, "a load of 0 or more")?,
        })
    })
}

/// Writes `force.csv`, so that it reads back bit by bit.
///
/// # Errors
/// If the writer fails or the robot has no such cable.
pub fn write_force(out: impl Write, pairs: &[ForcePair], robot: &Robot) -> IoResult<()> {
    let mut table = TableWriter::new(out, &COLUMNS)?;
    for pair in pairs {
        table.cable(pair.cable, robot)?;
        table.number(pair.reading_n)?;
        table.number(pair.load_n)?;
        table.end_row()?;
    }
    table.finish()
}
