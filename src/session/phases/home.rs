//! `home.csv`: readings of the six distance sensors of the home reference platform.

use std::io::{BufRead, Result as IoResult, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_files::ReadError;

use super::read_rows;
use crate::error::Loaded;
use crate::table::{Table, TableWriter};

/// Number of sensors of the home reference platform.
const SENSORS: i64 = 6;

/// One reading of a sensor; repeated readings of a sensor are in the order in which they were taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeReading {
    /// Index of the sensor, from 0.
    pub sensor: usize,
    /// Reading: volts if the sensor has a curve, else metres.
    pub reading: f64,
}

/// One measurement of the platform's pose with the encoders at zero, by any instrument.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomePose {
    /// Platform origin in the base frame (m).
    pub position_m: [f64; 3],
    /// Orientation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
    /// Standard deviation of each position coordinate (m).
    pub position_sd_m: f64,
    /// Standard deviation of each component of the rotation vector (rad).
    pub orientation_sd_rad: f64,
}

const COLUMNS: [&str; 2] = ["sensor", "reading"];

/// Reads `home.csv`; `file` is the name for messages.
///
/// # Errors
/// The first invalid row.
pub fn read_home(reader: impl BufRead, file: &str) -> Result<Loaded<Vec<HomeReading>>, ReadError> {
    let table = Table::open(reader, file)?;
    let [sensor, reading] = table.require_all(COLUMNS)?;
    read_rows(table, &COLUMNS, |row| {
        let number = row.integer(sensor)?;
        if !(1..=SENSORS).contains(&number) {
            return Err(row.unexpected(sensor, "a sensor from 1 to 6"));
        }
        Ok(HomeReading {
            sensor: (number - 1) as usize,
            reading: row.required(reading)?,
        })
    })
}

/// Writes `home.csv`, so that it reads back bit by bit.
///
/// # Errors
/// If the writer fails.
pub fn write_home(out: impl Write, readings: &[HomeReading]) -> IoResult<()> {
    let mut table = TableWriter::new(out, &COLUMNS)?;
    for reading in readings {
        table.integer(reading.sensor as i64 + 1)?;
        table.number(reading.reading)?;
        table.end_row()?;
    }
    table.finish()
}
