//! Hypothesis files: effects whose physics is a text, stated by the user.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use tautline_core::effect::{Hypothesis, MAX_HYPOTHESIS_BYTES};
use tautline_core::robot::Robot;

use crate::error::{Place, ReadError};
use crate::json::{check_size, read_limited};

/// Folder of hypotheses beside the tables of a dataset, and the ending of their files.
const FOLDER: &str = "effects";
const ENDING: &str = "toml";

/// Reads a hypothesis file.
///
/// # Errors
/// If the file cannot be read, or names the first mistake with its line and column.
pub fn read_hypothesis(path: &Path) -> Result<Hypothesis, ReadError> {
    let file = path.display().to_string();
    parse_hypothesis(
        &read_limited(path, &file, MAX_HYPOTHESIS_BYTES as u64)?,
        &file,
    )
}

/// Reads a hypothesis from memory; `file` is the name for messages.
///
/// # Errors
/// Names the first mistake with its line and column.
pub fn parse_hypothesis(bytes: &[u8], file: &str) -> Result<Hypothesis, ReadError> {
    check_size(bytes, file, MAX_HYPOTHESIS_BYTES as u64)?;
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let message = format!("found a byte that is not UTF-8 at {}", error.valid_up_to());
        ReadError::new(file, Place::File, message)
    })?;
    Hypothesis::parse(text).map_err(|error| {
        let place = Place::Character(error.line, error.column);
        ReadError::new(file, place, error.message)
    })
}

/// Reads a hypothesis file and makes it known to a robot.
///
/// # Errors
/// If the file is not valid, or the robot carries another hypothesis with the same identifier.
pub fn add_hypothesis(robot: &mut Robot, path: &Path) -> Result<(), ReadError> {
    let hypothesis = read_hypothesis(path)?;
    robot.add_hypothesis(hypothesis).map_err(|error| {
        let file = path.display().to_string();
        ReadError::new(&file, Place::File, error.to_string())
    })
}

/// Makes the hypotheses in the folder `effects` of a dataset known to its robot, in the order of their names.
///
/// # Errors
/// As [`add_hypothesis`].
pub(crate) fn add_hypotheses_beside(robot: &mut Robot, folder: &Path) -> Result<(), ReadError> {
    for path in hypothesis_files(&folder.join(FOLDER))? {
        add_hypothesis(robot, &path)?;
    }
    Ok(())
}

/// The hypothesis files of a folder, in the order of their names; none if there is no folder.
fn hypothesis_files(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let unreadable =
        |error: &std::io::Error| ReadError::io(&folder.display().to_string(), Place::File, error);
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(|error| unreadable(&error))?,
    };
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| unreadable(&error))?.path();
        if path.extension().is_some_and(|ending| ending == ENDING) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
