//! `elongation.csv`: elongation of a cable by its length and tension.

use std::io::{BufRead, Result as IoResult, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_files::ReadError;

use super::read_rows;
use crate::error::Loaded;
use crate::table::{Table, TableWriter};

/// One measured elongation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ElongationPoint {
    /// Length of the cable (m).
    pub length_m: f64,
    /// Tension (N).
    pub tension_n: f64,
    /// Elongation (m).
    pub elongation_m: f64,
}

const COLUMNS: [&str; 3] = ["length_m", "tension_n", "elongation_m"];

/// Reads `elongation.csv`; `file` is the name for messages.
///
/// # Errors
/// The first invalid row.
pub fn read_elongation(
    reader: impl BufRead,
    file: &str,
) -> Result<Loaded<Vec<ElongationPoint>>, ReadError> {
    let table = Table::open(reader, file)?;
    let [length, tension, elongation] = table.require_all(COLUMNS)?;
    read_rows(table, &COLUMNS, |row| {
        let length_m = row.required_if(
            length,
            |value| value > 0.0 && value <= 1e3,
            "a length in metres, more than 0 and at most 1 km",
        )?;
        Ok(ElongationPoint {
            length_m,
            tension_n: row.required_if(tension, |value| value >= 0.0, "a tension of 0 or more")?,
            elongation_m: row.required_if(
                elongation,
                |value| value.abs() < length_m,
                "metres, less than the length of the cable",
            )?,
        })
    })
}

/// Writes `elongation.csv`, so that it reads back bit by bit.
///
/// # Errors
/// If the writer fails.
pub fn write_elongation(out: impl Write, points: &[ElongationPoint]) -> IoResult<()> {
    let mut table = TableWriter::new(out, &COLUMNS)?;
    for point in points {
        table.number(point.length_m)?;
        table.number(point.tension_n)?;
        table.number(point.elongation_m)?;
        table.end_row()?;
    }
    table.finish()
}
