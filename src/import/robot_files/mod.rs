//! Files that describe a robot: those of other programs, and tables of the positions of its pulleys.

use std::path::{Path, PathBuf};

use tautline_core::robot::Robot;
use tautline_files::ReadError;
use tautline_session::Loaded;

use crate::robots::{PartPlaces, places_of, read_described};
use crate::sources::{holds_description, read_source};

/// Largest table of positions of pulleys (bytes).
const MAX_BYTES: u64 = 4 << 20;

/// Whether a file describes a robot.
///
/// # Errors
/// If it cannot be read.
pub fn is_robot_description(path: &Path) -> Result<bool, ReadError> {
    Ok(holds_description(path)? || read_places(path).is_some())
}

/// Reads a robot description: a text of firmware or of a simulator, the two files of cables and bodies of CASPR, a model of WireX,
/// or a table of the places of the pulleys.
///
/// # Errors
/// If a file is none of these, or does not describe a robot with one platform.
pub fn read_robot_description(paths: &[PathBuf]) -> Result<Loaded<Robot>, ReadError> {
    if let [path] = paths
        && !holds_description(path)?
        && let Some((places, notices)) = read_places(path)
    {
        return places.robot(&path.display().to_string(), notices);
    }
    read_described(paths)
}

/// The positions that a file states, and notices. Errors of a file are reported by the reader of its own format.
fn read_places(path: &Path) -> Option<(PartPlaces, Vec<String>)> {
    let is_small = path.metadata().is_ok_and(|data| data.len() <= MAX_BYTES);
    places_of(&is_small.then(|| read_source(path).ok())??)
}

#[cfg(test)]
mod tests;
