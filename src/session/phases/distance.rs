//! `distances.csv`: distances between poses, measured with a tape or on a board with marks.

use std::io::{BufRead, Result as IoResult, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::measurement::{DistanceReading, Measurements};
use tautline_files::ReadError;

use super::read_rows;
use crate::error::Loaded;
use crate::table::{Table, TableWriter};

/// Distance between the places of one point of the platform at two poses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseDistance {
    /// Labels of the poses.
    pub poses: [i64; 2],
    /// Distance (m).
    pub distance_m: f64,
    /// Its standard deviation (m).
    pub sd_m: f64,
    /// The point (m, platform frame); the origin if not stated.
    #[serde(default)]
    pub point_m: [f64; 3],
}

const COLUMNS: [&str; 7] = [
    "pose_a",
    "pose_b",
    "distance_m",
    "sd_m",
    "point_x_m",
    "point_y_m",
    "point_z_m",
];

/// Reads `distances.csv` for poses with these labels; `file` is the name for messages.
///
/// # Errors
/// The first invalid row.
pub fn read_distances(
    reader: impl BufRead,
    file: &str,
    labels: &[i64],
) -> Result<Loaded<Vec<PoseDistance>>, ReadError> {
    let table = Table::open(reader, file)?;
    let [required @ .., x, y, z] = COLUMNS;
    let [a, b, distance, sd] = table.require_all(required)?;
    let point = [x, y, z].map(|name| table.find(name));
    read_rows(table, &COLUMNS, |row| {
        let poses = [row.integer(a)?, row.integer(b)?];
        for (label, column) in poses.iter().zip([a, b]) {
            if !labels.contains(label) {
                return Err(row.unexpected(column, "the label of a measured pose"));
            }
        }
        if poses[0] == poses[1] {
            return Err(row.unexpected(b, "another pose than pose_a"));
        }
        let mut point_m = [0.0; 3];
        for (value, column) in point_m.iter_mut().zip(point) {
            *value = row.optional(column)?.unwrap_or(0.0);
        }
        let is_positive = |value: f64| value > 0.0 && value <= 1e3;
        Ok(PoseDistance {
            poses,
            distance_m: row.required_if(
                distance,
                is_positive,
                "a distance in metres, at most 1 km",
            )?,
            sd_m: row.required_if(sd, is_positive, "a standard deviation in metres, above 0")?,
            point_m,
        })
    })
}

/// Writes `distances.csv`, so that it reads back bit by bit.
///
/// # Errors
/// If the writer fails.
pub fn write_distances(out: impl Write, distances: &[PoseDistance]) -> IoResult<()> {
    let mut table = TableWriter::new(out, &COLUMNS)?;
    for one in distances {
        for label in one.poses {
            table.integer(label)?;
        }
        for value in [one.distance_m, one.sd_m].into_iter().chain(one.point_m) {
            table.number(value)?;
        }
        table.end_row()?;
    }
    table.finish()
}

/// The distances between measured poses, with their rows.
pub(crate) fn distance_readings(
    distances: &[PoseDistance],
    measurements: &Measurements,
) -> Vec<DistanceReading> {
    let row = |label: i64| measurements.labels.iter().position(|own| *own == label);
    let reading = |(k, one): (usize, &PoseDistance)| {
        let [Some(a), Some(b)] = one.poses.map(row) else {
            return None;
        };
        Some(DistanceReading {
            number: k + 1,
            rows: [a, b],
            point_m: one.point_m,
            distance_m: one.distance_m,
            sd_m: one.sd_m,
        })
    };
    distances.iter().enumerate().filter_map(reading).collect()
}
