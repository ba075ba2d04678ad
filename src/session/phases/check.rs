//! `check.csv`: commanded and attained poses of an ISO 9283 check.

use std::collections::HashSet;
use std::io::{BufRead, Result as IoResult, Write};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_files::ReadError;

use super::{once, read_rows};
use crate::error::Loaded;
use crate::table::{Table, TableRow, TableWriter};

/// Kind of target that a row of the check belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CheckKind {
    /// A commanded pose that is approached once per cycle.
    Pose,
    /// A path that is travelled once per cycle and sampled along it.
    Path,
}

/// One attained pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckRow {
    /// Pose or path.
    pub kind: CheckKind,
    /// Name of the commanded pose or path.
    pub target: String,
    /// Number of the repetition.
    pub cycle: i64,
    /// Number of the point along the path; 0 for a pose without a number.
    pub sample: i64,
    /// Time (s), if measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// Commanded pose.
    pub commanded: CheckPose,
    /// Pose attained according to the external instrument.
    pub attained: CheckPose,
}

impl CheckRow {
    /// Distance of the attained from the commanded position (m).
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        let [attained, commanded] = [&self.attained, &self.commanded];
        let pairs = attained.position_m.iter().zip(commanded.position_m);
        pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }
}

/// A pose whose orientation may be unknown.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckPose {
    /// Position (m).
    pub position_m: [f64; 3],
    /// Orientation, quaternion w first, if measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation_wxyz: Option<[f64; 4]>,
}

const HEAD: [&str; 5] = ["kind", "target", "cycle", "sample", "time_s"];
const COMMANDED: [&str; 7] = [
    "cmd_x_m", "cmd_y_m", "cmd_z_m", "cmd_qw", "cmd_qx", "cmd_qy", "cmd_qz",
];
const ATTAINED: [&str; 7] = ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"];

/// Reads `check.csv`; `file` is the name for messages.
///
/// # Errors
/// The first invalid row.
pub fn read_check(reader: impl BufRead, file: &str) -> Result<Loaded<Vec<CheckRow>>, ReadError> {
    let table = Table::open(reader, file)?;
    let [required @ .., sample, time] = HEAD;
    let [kind, target, cycle] = table.require_all(required)?;
    let (sample, time) = (table.find(sample), table.find(time));
    let commanded = PoseColumns::find(&table, &COMMANDED)?;
    let attained = PoseColumns::find(&table, &ATTAINED)?;
    let known = [HEAD.as_slice(), &COMMANDED, &ATTAINED].concat();
    let mut seen = HashSet::new();
    read_rows(table, &known, |row| {
        let kind = read_kind(row, kind)?;
        let target_name = row.text(target).to_string();
        if target_name.is_empty() {
            return Err(row.unexpected(target, "the name of a pose or path"));
        }
        let cycle_number = row.integer(cycle)?;
        let sample = read_sample(row, sample, kind)?;
        let key = (kind, target_name.clone(), cycle_number, sample);
        once(&mut seen, key, row, cycle, "cycle of a target")?;
        Ok(CheckRow {
            kind,
            target: target_name,
            cycle: cycle_number,
            sample,
            time_s: row.optional(time)?,
            commanded: commanded.read(row)?,
            attained: attained.read(row)?,
        })
    })
}

fn read_kind(row: &TableRow<'_>, column: usize) -> Result<CheckKind, ReadError> {
    match row.text(column) {
        "pose" => Ok(CheckKind::Pose),
        "path" => Ok(CheckKind::Path),
        _ => Err(row.unexpected(column, "pose or path")),
    }
}

/// Points of a path are numbered; a pose is one point.
fn read_sample(
    row: &TableRow<'_>,
    column: Option<usize>,
    kind: CheckKind,
) -> Result<i64, ReadError> {
    match column {
        Some(column) if kind == CheckKind::Path || !row.text(column).is_empty() => {
            row.integer(column)
        }
        _ => Ok(0),
    }
}

/// Columns of the seven numbers of a pose.
pub(crate) struct PoseColumns {
    position: [usize; 3],
    quaternion: Option<[usize; 4]>,
}

impl PoseColumns {
    /// Finds the columns by name; a quaternion must have all its columns or none.
    pub fn find<R: BufRead>(table: &Table<R>, names: &[&str; 7]) -> Result<Self, ReadError> {
        let [x, y, z, quaternion @ ..] = *names;
        let measured = quaternion.iter().any(|name| table.find(name).is_some());
        Ok(Self {
            position: table.require_all([x, y, z])?,
            quaternion: measured
                .then(|| table.require_all(quaternion))
                .transpose()?,
        })
    }

    /// The pose in a row.
    pub fn read(&self, row: &TableRow<'_>) -> Result<CheckPose, ReadError> {
        let mut position_m = [0.0; 3];
        for (value, column) in position_m.iter_mut().zip(self.position) {
            *value = row.required_if(
                column,
                |value| value.abs() <= 1e3,
                "a position in metres, at most 1 km",
            )?;
        }
        let orientation = self.quaternion.map(|columns| row.quaternion(columns));
        Ok(CheckPose {
            position_m,
            orientation_wxyz: orientation.transpose()?.flatten(),
        })
    }
}

/// Writes `check.csv`, so that it reads back bit by bit.
///
/// # Errors
/// If the writer fails.
pub fn write_check(out: impl Write, rows: &[CheckRow]) -> IoResult<()> {
    let names = [HEAD.as_slice(), &COMMANDED, &ATTAINED].concat();
    let mut table = TableWriter::new(out, &names)?;
    for row in rows {
        table.text(match row.kind {
            CheckKind::Pose => "pose",
            CheckKind::Path => "path",
        })?;
        table.text(&row.target)?;
        table.integer(row.cycle)?;
        table.integer(row.sample)?;
        table.number(row.time_s.unwrap_or(f64::NAN))?;
        for pose in [&row.commanded, &row.attained] {
            let orientation = pose.orientation_wxyz.unwrap_or([f64::NAN; 4]);
            for value in pose.position_m.iter().chain(&orientation) {
                table.number(*value)?;
            }
        }
        table.end_row()?;
    }
    table.finish()
}
