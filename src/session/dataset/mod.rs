//! Dataset folders: `robot.json`, `poses.csv`, the optional tables of the phases, and hypotheses in `effects/`.

use std::fs::{self, File};
use std::io::{BufReader, ErrorKind, Result as IoResult, Write};
use std::path::Path;

use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_files::{Location, ReadError, open_input};

use crate::atomic::write_atomically;
use crate::error::{Loaded, WriteError};
use crate::hypothesis_file::add_hypotheses_beside;
use crate::phases::{self, PhaseData};
use crate::poses::{PoseLines, read_poses_and_lines, write_poses};
use crate::robot_file::{read_measured_at, read_robot, write_robot};
use crate::session::Timestamp;

/// Names of the files of a dataset folder.
pub(crate) const ROBOT: &str = "robot.json";
pub(crate) const POSES: &str = "poses.csv";
const WINCH: &str = "winch.csv";
const FORCE: &str = "force.csv";
const HOME: &str = "home.csv";
const ELONGATION: &str = "elongation.csv";
const CHECK: &str = "check.csv";
const DISTANCES: &str = "distances.csv";

/// Content of a dataset folder.
#[derive(Debug, Clone, PartialEq)]
pub struct DatasetFolder {
    /// The robot and the measurements.
    pub dataset: Dataset,
    /// Lines of `poses.csv`, for messages about the measurements.
    pub lines: PoseLines,
    /// The optional tables; empty if the file is absent.
    pub phases: PhaseData,
    /// Time at which the poses were read, if `robot.json` states it.
    pub measured_at: Option<Timestamp>,
    /// Notices for the operator, one sentence each.
    pub notices: Vec<String>,
}

/// Reads a dataset folder; `robot.json` and `poses.csv` are required. The robot knows the hypotheses in its folder `effects`.
///
/// # Errors
/// Names the first file that is missing or invalid, and the place in it.
pub fn read_dataset(folder: &Path) -> Result<DatasetFolder, ReadError> {
    require_folder(folder)?;
    let mut robot = read_robot(&folder.join(ROBOT))?;
    add_hypotheses_beside(&mut robot.value, folder)?;
    let mut files = Files {
        folder,
        robot: &robot.value,
        notices: robot.notices.clone(),
    };
    let (mut measurements, lines) = files.require(POSES, read_poses_and_lines)?;
    let labels = &measurements.labels;
    let distances = files.find(DISTANCES, |reader, file, _| {
        phases::read_distances(reader, file, labels)
    })?;
    measurements.distances = phases::distance_readings(&distances, &measurements);
    let phases = PhaseData {
        distances,
        check: files.find(CHECK, |reader, file, _| phases::read_check(reader, file))?,
        ..files.phases_1_and_2()?
    };
    let notices = files.notices;
    Ok(DatasetFolder {
        dataset: Dataset {
            robot: robot.value,
            measurements,
        },
        lines,
        phases,
        measured_at: read_measured_at(&folder.join(ROBOT))?,
        notices,
    })
}

/// Reads the robot and the tables of phases 1 and 2 of a dataset folder, which precede the measured
/// poses: `poses.csv` and `check.csv` are not required and not read.
///
/// # Errors
/// Names the first file that is missing or invalid, and the place in it.
pub fn read_calibration_tables(folder: &Path) -> Result<Loaded<(Robot, PhaseData)>, ReadError> {
    require_folder(folder)?;
    let mut robot = read_robot(&folder.join(ROBOT))?;
    add_hypotheses_beside(&mut robot.value, folder)?;
    let mut files = Files {
        folder,
        robot: &robot.value,
        notices: robot.notices,
    };
    let phases = files.phases_1_and_2()?;
    let notices = files.notices;
    Ok(Loaded {
        value: (robot.value, phases),
        notices,
    })
}

/// Reads a single `check.csv`.
///
/// # Errors
/// If the file cannot be read or a row is invalid.
pub fn read_check_file(path: &Path) -> Result<Loaded<Vec<phases::CheckRow>>, ReadError> {
    read_table_file(path, phases::read_check)
}

/// Reads a single table at any path; `read` gets its content and its name for messages.
///
/// # Errors
/// If the file cannot be read or a row is invalid.
pub fn read_table_file<T>(
    path: &Path,
    read: impl FnOnce(BufReader<File>, &str) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    let file = path.display().to_string();
    read(open(path, &file)?, &file)
}

fn require_folder(folder: &Path) -> Result<(), ReadError> {
    let file = folder.display().to_string();
    let message = match fs::metadata(folder) {
        Ok(metadata) if metadata.is_dir() => return Ok(()),
        Ok(_) => "is a file, expected a dataset folder",
        Err(error) if error.kind() == ErrorKind::NotFound => "not found, expected a dataset folder",
        Err(error) => return Err(ReadError::io(&file, Location::File, &error)),
    };
    Err(ReadError::new(&file, Location::File, message))
}

fn open(path: &Path, file: &str) -> Result<BufReader<File>, ReadError> {
    let input = open_input(path, file)?;
    Ok(BufReader::with_capacity(1 << 16, input))
}

/// The tables of one folder, and the notices so far.
struct Files<'a> {
    folder: &'a Path,
    robot: &'a Robot,
    notices: Vec<String>,
}

impl Files<'_> {
    fn phases_1_and_2(&mut self) -> Result<PhaseData, ReadError> {
        Ok(PhaseData {
            winch: self.find(WINCH, phases::read_winch)?,
            force: self.find(FORCE, phases::read_force)?,
            home: self.find(HOME, |reader, file, _| phases::read_home(reader, file))?,
            elongation: self.find(ELONGATION, |reader, file, _| {
                phases::read_elongation(reader, file)
            })?,
            ..PhaseData::default()
        })
    }

    fn require<T>(
        &mut self,
        name: &str,
        read: impl FnOnce(BufReader<File>, &str, &Robot) -> Result<Loaded<T>, ReadError>,
    ) -> Result<T, ReadError> {
        let path = self.folder.join(name);
        let file = path.display().to_string();
        let loaded = read(open(&path, &file)?, &file, self.robot)?;
        self.notices.extend(loaded.notices);
        Ok(loaded.value)
    }

    fn find<T: Default>(
        &mut self,
        name: &str,
        read: impl FnOnce(BufReader<File>, &str, &Robot) -> Result<Loaded<T>, ReadError>,
    ) -> Result<T, ReadError> {
        match fs::symlink_metadata(self.folder.join(name)) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(T::default()),
            _ => self.require(name, read),
        }
    }
}

/// Writes a dataset folder, creating it if necessary; each file is written atomically.
///
/// # Errors
/// If a file cannot be written, or the folder contains a table that these data do not have: it would
/// be read as a part of them, and this program must not delete it.
pub fn write_dataset(
    folder: &Path,
    dataset: &Dataset,
    phases: &PhaseData,
) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|error| WriteError::io(folder, error))?;
    let optional = [
        (WINCH, phases.winch.is_empty()),
        (FORCE, phases.force.is_empty()),
        (HOME, phases.home.is_empty()),
        (ELONGATION, phases.elongation.is_empty()),
        (CHECK, phases.check.is_empty()),
        (DISTANCES, phases.distances.is_empty()),
    ];
    for (name, is_absent) in optional {
        let path = folder.join(name);
        if is_absent && path.exists() {
            return Err(WriteError::OtherDataset { path });
        }
    }
    let robot = &dataset.robot;
    write_robot(&folder.join(ROBOT), robot)?;
    write_atomically(&folder.join(POSES), |out| {
        write_poses(out, &dataset.measurements)
    })?;
    write_some(folder, WINCH, &phases.winch, |out, rows| {
        phases::write_winch(out, rows, robot)
    })?;
    write_some(folder, FORCE, &phases.force, |out, rows| {
        phases::write_force(out, rows, robot)
    })?;
    write_some(folder, HOME, &phases.home, |out, rows| {
        phases::write_home(out, rows)
    })?;
    write_some(folder, ELONGATION, &phases.elongation, |out, rows| {
        phases::write_elongation(out, rows)
    })?;
    write_some(folder, DISTANCES, &phases.distances, |out, rows| {
        phases::write_distances(out, rows)
    })?;
    write_some(folder, CHECK, &phases.check, |out, rows| {
        phases::write_check(out, rows)
    })
}

fn write_some<T>(
    folder: &Path,
    name: &str,
    rows: &[T],
    write: impl FnOnce(&mut dyn Write, &[T]) -> IoResult<()>,
) -> Result<(), WriteError> {
    if rows.is_empty() {
        return Ok(());
    }
    write_atomically(&folder.join(name), |out| write(out, rows))
}

#[cfg(test)]
mod tests;
