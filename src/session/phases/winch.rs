//! `winch.csv`: revolutions of a winch and the measured cable lengths.

use std::io::{BufRead, Result as IoResult, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::Robot;
use tautline_files::ReadError;

use super::{cable, read_rows};
use crate::error::Loaded;
use crate::table::{Table, TableWriter};

/// One calibration pair of a winch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WinchPair {
    /// Index of the cable, from 0.
    pub cable: usize,
    /// Motor revolutions.
    pub revolutions: f64,
    /// Measured length (m).
    pub length_m: f64,
    /// Tension during the measurement (N), if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tension_n: Option<f64>,
}

const COLUMNS: [&str; 4] = ["cable", "rev", "length_m", "tension_n"];

/// Reads `winch.csv`; `file` is the name for messages.
///
/// # Errors
/// The first invalid row.
pub fn read_winch(
    reader: impl BufRead,
    file: &str,
    robot: &Robot,
) -> Result<Loaded<Vec<WinchPair>>, ReadError> {
    let table = Table::open(reader, file)?;
    let [required @ .., optional] = COLUMNS;
    let [name, rev, length] = table.require_all(required)?;
    let tension = table.find(optional);
    read_rows(table, &COLUMNS, |row| {
        Ok(WinchPair {
            cable: cable(row, name, robot)?,
            revolutions: row.required(rev)?,
            length_m: row.required_if(
                length,
                |value| value.abs() <= 1e3,
                "a length in metres, at most 1 km",
            )?,
            tension_n: row.optional(tension)?,
        })
    })
}

/// Writes `winch.csv`, so that it reads back bit by bit.
///
/// # Errors
/// If the writer fails or the robot has no such cable.
pub fn write_winch(out: impl Write, pairs: &[WinchPair], robot: &Robot) -> IoResult<()> {
    let with_tension = pairs.iter().any(|pair| pair.tension_n.is_some());
    let columns = if with_tension { 4 } else { 3 };
    let mut table = TableWriter::new(out, &COLUMNS[..columns])?;
    for pair in pairs {
        table.cable(pair.cable, robot)?;
        table.number(pair.revolutions)?;
        table.number(pair.length_m)?;
        if with_tension {
            table.number(pair.tension_n.unwrap_or(f64::NAN))?;
        }
        table.end_row()?;
    }
    table.finish()
}
