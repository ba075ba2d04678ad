//! Raw data of the phases around the poses: plain rows, one file each.

mod check;
mod distance;
mod elongation;
mod force;
mod home;
mod winch;

use std::collections::HashSet;
use std::hash::Hash;
use std::io::BufRead;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::Robot;
use tautline_files::ReadError;

use crate::error::Loaded;
use crate::table::{Table, TableRow};
pub(crate) use check::PoseColumns;
pub use check::{CheckKind, CheckPose, CheckRow, read_check, write_check};
pub(crate) use distance::distance_readings;
pub use distance::{PoseDistance, read_distances, write_distances};
pub use elongation::{ElongationPoint, read_elongation, write_elongation};
pub use force::{ForcePair, read_force, write_force};
pub use home::{HomePose, HomeReading, read_home, write_home};
pub use winch::{WinchPair, read_winch, write_winch};

/// Raw data beside the measured poses; empty if not measured.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct PhaseData {
    /// Winch calibration of phase 1 (`winch.csv`).
    pub winch: Vec<WinchPair>,
    /// Force sensor calibration of phase 1 (`force.csv`).
    pub force: Vec<ForcePair>,
    /// Readings of the home reference platform of phase 1 (`home.csv`).
    pub home: Vec<HomeReading>,
    /// Measurements of the home pose by other instruments; a session has them, a dataset folder does not.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub home_poses: Vec<HomePose>,
    /// Elongation measurements of phase 2 (`elongation.csv`).
    pub elongation: Vec<ElongationPoint>,
    /// Distances between measured poses (`distances.csv`).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub distances: Vec<PoseDistance>,
    /// Poses and paths checked by an external instrument in phase 5 (`check.csv`).
    pub check: Vec<CheckRow>,
}

/// Reads all rows of a table with `read_row`; columns not in `known` become notices.
pub(crate) fn read_rows<T, R: BufRead>(
    mut table: Table<R>,
    known: &[&str],
    mut read_row: impl FnMut(&TableRow<'_>) -> Result<T, ReadError>,
) -> Result<Loaded<Vec<T>>, ReadError> {
    let notices = table.unknown_columns(known);
    let mut value = Vec::new();
    while let Some(row) = table.next_row()? {
        value.push(read_row(&row)?);
    }
    Ok(Loaded { value, notices })
}

/// Index of the cable in a cell, given by its name or by its number from 1.
fn cable(row: &TableRow<'_>, column: usize, robot: &Robot) -> Result<usize, ReadError> {
    let text = row.text(column);
    let number = || text.parse::<usize>().ok()?.checked_sub(1);
    robot
        .cable_index(text)
        .or_else(|| number().filter(|index| *index < robot.cable_count()))
        .ok_or_else(|| {
            let count = robot.cable_count();
            let expected = format!("the name of a cable or a number from 1 to {count}");
            row.unexpected(column, &expected)
        })
}

/// Rejects a second row about the same item.
pub(crate) fn once<K: Hash + Eq>(
    seen: &mut HashSet<K>,
    key: K,
    row: &TableRow<'_>,
    column: usize,
    what: &str,
) -> Result<(), ReadError> {
    if seen.insert(key) {
        Ok(())
    } else {
        Err(row.unexpected(column, &format!("each {what} once")))
    }
}

#[cfg(test)]
mod tests;
