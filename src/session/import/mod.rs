//! Import of any file or folder, recognised by its content.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::Path;

use serde_json::Value;
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::Robot;
use tautline_files::{Location, ReadError, open_input, quoted};

use crate::dataset::{DatasetFolder, POSES, ROBOT, read_calibration_tables, read_dataset};
use crate::error::Loaded;
use crate::json::{VersionedFile, check_size, kind, parse_object, read_limited, versioned_from};
use crate::phases::{
    self, CheckRow, ElongationPoint, ForcePair, HomeReading, PoseDistance, WinchPair, read_check,
    read_distances, read_elongation, read_home,
};
use crate::plan_table::read_plan;
use crate::poses::{Group, LABEL, PoseColumn, PoseLines, read_poses};
use crate::session::{PlannedPose, Session, SessionFile, checked};
use crate::table::Table;

/// Imported content.
#[derive(Debug, Clone, PartialEq)]
pub enum Import {
    /// A session file.
    Session(Box<Session>),
    /// A `robot.json` or model file.
    Robot(Box<Robot>),
    /// A dataset folder; without `poses.csv` it has no measurements.
    Dataset(Box<DatasetFolder>),
    /// A table of measured poses.
    Poses(Box<Measurements>),
    /// Calibration of the winches.
    Winch(Vec<WinchPair>),
    /// Calibration of the force sensors.
    Force(Vec<ForcePair>),
    /// Readings of the home reference platform.
    Home(Vec<HomeReading>),
    /// Elongation of the cables.
    Elongation(Vec<ElongationPoint>),
    /// Distances between measured poses.
    Distances(Vec<PoseDistance>),
    /// Poses and paths checked by an external instrument.
    Check(Vec<CheckRow>),
    /// Poses to be measured.
    Plan(Vec<PlannedPose>),
}

/// Kinds of tables that are recognised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TableKind {
    Poses,
    Plan,
    Winch,
    Force,
    Home,
    Elongation,
    Distances,
    Check,
}

/// Tables other than those of poses, and the columns that identify them.
const MARKS: [(TableKind, &[&str]); 6] = [
    (TableKind::Winch, &["cable", "rev", "length_m"]),
    (TableKind::Force, &["cable", "reading_n", "load_n"]),
    (TableKind::Home, &["sensor", "reading"]),
    (
        TableKind::Elongation,
        &["length_m", "tension_n", "elongation_m"],
    ),
    (
        TableKind::Distances,
        &["pose_a", "pose_b", "distance_m", "sd_m"],
    ),
    (
        TableKind::Check,
        &["kind", "target", "cycle", "cmd_x_m", "cmd_y_m", "cmd_z_m"],
    ),
];

const EXPECTED: &str = "expected a session, a robot, a dataset folder, or a table of poses, \
                          a plan, or winch, force, home, elongation, distance or check readings";
const OTHERS: &str = "files of other programs are read by `tautline import`";

/// Reads a file or folder of any kind; tables are read for the robot of the session `into`.
///
/// # Errors
/// If the kind is not recognised, a table needs a robot and there is no session, or the
/// content is invalid, with the place in the file.
pub fn import(path: &Path, into: Option<&Session>) -> Result<Loaded<Import>, ReadError> {
    let file = path.display().to_string();
    let fail = |error| ReadError::io(&file, Location::File, &error);
    if fs::metadata(path).map_err(fail)?.is_dir() {
        return import_folder(path, &file);
    }
    let bytes = read_limited(path, &file, SessionFile::MAX_BYTES)?;
    check_size(&bytes, &file, SessionFile::MAX_BYTES)?;
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    match text.trim_ascii_start().first() {
        None => {
            let message = format!("found an empty file, {EXPECTED}");
            Err(ReadError::new(&file, Location::File, message))
        }
        Some(b'{' | b'[') => import_json(&bytes, &file),
        Some(_) => import_table(&bytes, &file, into),
    }
}

/// Whether a file or folder is of a format of Tautline, valid or not, rather than of another program. If it is not valid,
/// [`import`] reports the error.
///
/// # Errors
/// If it cannot be read.
pub fn is_own(path: &Path) -> Result<bool, ReadError> {
    let file = path.display().to_string();
    let fail = |error| ReadError::io(&file, Location::File, &error);
    if fs::metadata(path).map_err(fail)?.is_dir() {
        return Ok(path.join(ROBOT).exists());
    }
    let mut reader = BufReader::with_capacity(1 << 16, open_input(path, &file)?);
    let head = reader.fill_buf().map_err(fail)?;
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    Ok(match text.trim_ascii_start().first() {
        None | Some(b'{' | b'[') => true,
        Some(_) if is_binary(head) => false,
        Some(_) => Table::open(head, &file).is_ok_and(|table| recognise(table.names()).is_some()),
    })
}

fn import_folder(folder: &Path, file: &str) -> Result<Loaded<Import>, ReadError> {
    if !folder.join(ROBOT).exists() {
        let message = format!("found a folder without {ROBOT}, {EXPECTED}");
        return Err(ReadError::new(file, Location::File, message));
    }
    let dataset = if folder.join(POSES).exists() {
        read_dataset(folder)?
    } else {
        let loaded = read_calibration_tables(folder)?;
        let (robot, phases) = loaded.value;
        DatasetFolder {
            dataset: Dataset {
                robot,
                measurements: Measurements::default(),
            },
            lines: PoseLines::default(),
            phases,
            measured_at: None,
            notices: loaded.notices,
        }
    };
    Ok(Loaded {
        notices: dataset.notices.clone(),
        value: Import::Dataset(Box::new(dataset)),
    })
}

fn import_json(bytes: &[u8], file: &str) -> Result<Loaded<Import>, ReadError> {
    let object = parse_object(bytes, file)?;
    let (session, robot) = (SessionFile::FORMAT, Robot::FORMAT);
    let found = match object.get("format") {
        Some(Value::String(format)) if format == session => {
            let loaded = checked(versioned_from(object, file)?, file)?;
            return Ok(loaded.map(|value| Import::Session(Box::new(value))));
        }
        Some(Value::String(format)) if format == robot => {
            let loaded = versioned_from(object, file)?;
            return Ok(loaded.map(|value| Import::Robot(Box::new(value))));
        }
        Some(other) => format!("found {}", kind(other)),
        None => "not given".into(),
    };
    let message = format!("{found}, expected {session:?} or {robot:?}");
    let place = Location::Pointer("/format".into());
    Err(ReadError::new(file, place, message))
}

fn import_table(
    bytes: &[u8],
    file: &str,
    into: Option<&Session>,
) -> Result<Loaded<Import>, ReadError> {
    if is_binary(bytes) {
        let message = format!("found a binary file, {EXPECTED}; {OTHERS}");
        return Err(ReadError::new(file, Location::File, message));
    }
    let names = Table::open(bytes, file)?.names().to_vec();
    let Some(kind) = recognise(&names) else {
        let names: Vec<String> = names.iter().take(6).map(|name| quoted(name)).collect();
        let message = format!(
            "found a table with the columns {}, {EXPECTED}; {OTHERS}",
            names.join(", ")
        );
        return Err(ReadError::new(file, Location::File, message));
    };
    let robot = || {
        into.map(|session| &session.robot).ok_or_else(|| {
            let what = kind.describe();
            let message = format!("found {what}, expected an open session that it belongs to");
            ReadError::new(file, Location::File, message)
        })
    };
    Ok(match kind {
        TableKind::Poses => {
            read_poses(bytes, file, robot()?)?.map(|poses| Import::Poses(Box::new(poses)))
        }
        TableKind::Plan => read_plan(bytes, file, robot()?)?.map(Import::Plan),
        TableKind::Winch => phases::read_winch(bytes, file, robot()?)?.map(Import::Winch),
        TableKind::Force => phases::read_force(bytes, file, robot()?)?.map(Import::Force),
        TableKind::Home => read_home(bytes, file)?.map(Import::Home),
        TableKind::Elongation => read_elongation(bytes, file)?.map(Import::Elongation),
        TableKind::Distances => {
            let labels = into.map_or(&[][..], |session| &session.measurements.labels);
            robot()?;
            read_distances(bytes, file, labels)?.map(Import::Distances)
        }
        TableKind::Check => read_check(bytes, file)?.map(Import::Check),
    })
}

/// Binary files have zero bytes early on. UTF-16 text has them too, but for that the table reader has a better message.
fn is_binary(bytes: &[u8]) -> bool {
    let is_utf_16 = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    !is_utf_16 && bytes.iter().take(1024).any(|byte| *byte == 0)
}

impl TableKind {
    fn describe(self) -> &'static str {
        match self {
            Self::Poses => "a table of poses",
            Self::Plan => "a plan of poses",
            Self::Winch => "a table of winch readings",
            Self::Force => "a table of force readings",
            Self::Home => "a table of home readings",
            Self::Elongation => "a table of elongations",
            Self::Distances => "a table of distances",
            Self::Check => "a table of checked poses",
        }
    }
}

/// The kind of table with such columns. One column may be missing; the reader of the table names it.
fn recognise(names: &[String]) -> Option<TableKind> {
    let columns: Vec<PoseColumn> = names
        .iter()
        .filter_map(|name| PoseColumn::parse(name))
        .collect();
    let is_commanded =
        |column: &PoseColumn| matches!(column, PoseColumn::Component(Group::Commanded, _));
    let per_cable = columns.iter().any(|c| matches!(c, PoseColumn::Cable(..)));
    if per_cable || names.iter().any(|name| name.eq_ignore_ascii_case(LABEL)) {
        let is_plan = !columns.is_empty() && columns.iter().all(is_commanded);
        return Some(if is_plan {
            TableKind::Plan
        } else {
            TableKind::Poses
        });
    }
    let found = |marks: &[&str]| {
        let there = marks.iter().filter(|mark| names.iter().any(|n| n == *mark));
        there.count() as f64 / marks.len() as f64
    };
    let best = MARKS.iter().map(|(kind, marks)| (*kind, found(marks)));
    let best = best.reduce(|best, next| if next.1 > best.1 { next } else { best });
    match best {
        Some((kind, share)) if share >= 0.5 => Some(kind),
        _ if columns.len() >= 3 && columns.iter().all(is_commanded) => Some(TableKind::Plan),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
