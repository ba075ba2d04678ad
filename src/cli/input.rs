//! Reading of input files; notices about them go to standard error.

use crate::output::note;
use std::path::Path;

use crate::BadInput;
use anyhow::Result;
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_core::robot::presets::{self, Preset};
use tautline_session::{
    DatasetFolder, Loaded, PoseLines, Session, import, read_dataset, read_robot,
};
use tautline_workflow::clock;
use tautline_workflow::comparison::as_session;
use tautline_workflow::readiness::reading_faults;

/// Prints the notices and returns what was read.
pub fn noticed<T>(read: Loaded<T>) -> T {
    for notice in &read.notices {
        note!("{notice}");
    }
    read.value
}

/// Reads a session, or creates one from a robot or a dataset folder.
pub fn session(path: &Path) -> Result<Session> {
    if !path.exists() {
        let place = path.display();
        let message = format!("{place}: not found, expected a session file or a dataset folder");
        return Err(BadInput::new(message));
    }
    let imported = noticed(import(path, None)?);
    let (session, notices) = as_session(path, imported, clock::now()).map_err(BadInput::new)?;
    for notice in &notices {
        note!("{notice}");
    }
    note_faults(&session.dataset(), None);
    Ok(session)
}

/// Reads a dataset folder; readings that cannot be right are noted.
pub fn dataset(folder: &Path) -> Result<Dataset> {
    let read = dataset_and_lines(folder)?;
    note_faults(&read.dataset, Some(&read.lines));
    Ok(read.dataset)
}

/// Reads a dataset folder from which a robot can be identified.
pub fn identifiable_dataset(folder: &Path) -> Result<Dataset> {
    let read = dataset_and_lines(folder)?;
    let faults = reading_faults(&read.dataset);
    if let Some(fault) = faults.iter().find(|fault| fault.prevents_identification) {
        let error = read.lines.error(fault.row, &fault.column, &fault.message);
        return Err(error.into());
    }
    note_faults(&read.dataset, Some(&read.lines));
    Ok(read.dataset)
}

/// Reads a dataset folder, with the lines of its measurements.
pub fn dataset_and_lines(folder: &Path) -> Result<DatasetFolder> {
    let read = read_dataset(folder)?;
    for notice in &read.notices {
        note!("{notice}");
    }
    Ok(read)
}

fn note_faults(dataset: &Dataset, table: Option<&PoseLines>) {
    for fault in reading_faults(dataset) {
        note!("{}", fault.sentence(dataset, table));
    }
}

/// A robot named by an argument.
pub struct RobotSource {
    /// The robot.
    pub robot: Robot,
    /// The preset, if it does not come from a file.
    pub preset: Option<Preset>,
}

/// The preset with this name, or the robot of this file.
pub fn robot(name: &str) -> Result<RobotSource> {
    if let Some(preset) = presets::find(name) {
        return Ok(RobotSource {
            robot: preset.robot.clone(),
            preset: Some(preset),
        });
    }
    let path = Path::new(name);
    if !path.exists() {
        let presets = presets::NAMES.join(", ");
        let message = format!("--robot: found \"{name}\", expected a file or one of {presets}");
        return Err(BadInput::new(message));
    }
    Ok(RobotSource {
        robot: noticed(read_robot(path)?),
        preset: None,
    })
}
