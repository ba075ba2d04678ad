//! Import of files of other programs, from opening a path to the dataset of a session.

mod figure;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use tautline_channels::{MemoryBudget, Source};
use tautline_core::robot::Robot;
use tautline_files::ReadError;
use tautline_import::{
    Imported, Recipe, import as import_sources, is_robot_description, read_recipe,
    read_robot_description, read_sources,
};
use tautline_session::{
    Import, Loaded, LogEntry, Phase, ResultRecord, Session, Timestamp, VersionedFile, import,
    is_own,
};

use crate::results::record;
pub use figure::{Outlines, channel_figure};

/// Content of an opened path.
#[derive(Debug)]
pub enum Opened {
    /// A file of Tautline.
    Own(Box<Import>),
    /// A robot description of another program.
    Robot(Box<Robot>),
    /// A recipe for importing.
    Recipe(Box<Recipe>),
    /// Readings from a file or folder of another program.
    Sources(Vec<Source>),
}

/// Opens `path`, whose kind is recognised by its content; `into` is the open session. `goes_on` is called with the fraction
/// read so far, and returns whether to continue.
///
/// # Errors
/// If no reader recognises it; one sentence with the place.
pub fn open(
    path: &Path,
    into: Option<&Session>,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<Loaded<Opened>, ReadError> {
    if is_own(path)? {
        return match import(path, into) {
            Ok(loaded) => Ok(loaded.map(|own| Opened::Own(Box::new(own)))),
            Err(error) => read_recipe(path)
                .map(|loaded| loaded.map(|recipe| Opened::Recipe(Box::new(recipe))))
                .map_err(|_| error),
        };
    }
    let paths = [path.to_owned()];
    if !path.is_dir() && is_robot_description(path)? {
        let robot = read_robot_description(&robot_files(path))?;
        return Ok(robot.map(|robot| Opened::Robot(Box::new(robot))));
    }
    Ok(read_sources(&paths, &MemoryBudget::default(), goes_on)?.map(Opened::Sources))
}

/// The files of a robot description: those of CASPR are two in one folder, bodies and cables.
fn robot_files(path: &Path) -> Vec<PathBuf> {
    let mut files = vec![path.to_owned()];
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    for (own, other) in [("_cables.", "_bodies."), ("_bodies.", "_cables.")] {
        let beside = path.with_file_name(name.replacen(own, other, 1));
        if name.contains(own) && beside.is_file() {
            files.push(beside);
        }
    }
    files
}

fn last_record(session: &Session) -> Option<&ResultRecord> {
    let of_recipe = |record: &&ResultRecord| record.format() == Some(Recipe::FORMAT);
    session.results().iter().rev().find(of_recipe)
}

/// The recipe of the last import of a session.
#[must_use]
pub fn last_recipe(session: &Session) -> Option<Recipe> {
    serde_json::from_value(last_record(session)?.document.value()).ok()
}

/// Whether another import can replace the poses of a session: they were imported, and nothing was planned or measured since.
/// Measured poses are in no file from which they could be read again.
#[must_use]
pub fn can_import_again(session: &Session) -> bool {
    let is_poses = |entry: &&LogEntry| entry.phase == Phase::Poses;
    let last_step = session.log().iter().rev().find(is_poses);
    last_record(session).is_some_and(|record| {
        !session.measurements.is_empty() && last_step.is_none_or(|step| step.time <= record.time)
    })
}

/// A recipe in the form that sessions record.
#[must_use]
pub fn recipe_record(session: &Session, recipe: &Recipe, now: Timestamp) -> ResultRecord {
    record(session, "Recipe of the import", recipe, now)
}

/// A new session from imported measurements.
#[must_use]
pub fn session_of(name: &str, robot: Robot, imported: &Imported, now: Timestamp) -> Session {
    let mut session = Session::new(name, robot, now);
    session.measurements = imported.measurements.clone();
    session
}

/// Imports sources by a recipe, which has no name in messages because it is on the screen.
///
/// # Errors
/// As [`tautline_import::import`].
pub fn cut(
    sources: &[Source],
    recipe: &Recipe,
    robot: &Robot,
) -> Result<Imported, tautline_import::ImportError> {
    import_sources(
        sources,
        recipe,
        "the recipe",
        robot,
        &MemoryBudget::default(),
    )
}
