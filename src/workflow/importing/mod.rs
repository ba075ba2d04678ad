//! Files of other programs, from what was opened to the dataset of a session.

mod figure;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use tautline_core::robot::Robot;
use tautline_import::{
    Imported, Recipe, Source, import as import_sources, is_robot_description, read_recipe,
    read_robot_description, read_sources,
};
use tautline_session::{
    Import, Loaded, ReadError, ResultRecord, Session, Timestamp, VersionedFile, import, is_own,
};

use crate::documents::record;
pub use figure::{Outlines, channel_figure};

/// What was opened.
#[derive(Debug)]
pub enum Opened {
    /// One of our own files.
    Own(Box<Import>),
    /// The description of a robot by another program.
    Robot(Box<Robot>),
    /// A recipe for importing.
    Recipe(Box<Recipe>),
    /// Readings in a file or folder of another program.
    Sources(Vec<Source>),
}

/// Opens whatever `path` is, recognised by its content; `into` is the open session. Meanwhile `goes_on` is told which part
/// is read, and says whether to read on.
///
/// # Errors
/// If nothing reads it, in one sentence with the place.
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
    Ok(read_sources(&paths, goes_on)?.map(Opened::Sources))
}

/// The description of a robot is in two files of one folder: that of the bodies belongs to that of the cables.
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

/// The recipe of the last import of a session.
#[must_use]
pub fn last_recipe(session: &Session) -> Option<Recipe> {
    let of_recipe = |record: &&ResultRecord| record.format() == Some(Recipe::FORMAT);
    let record = session.results().iter().rev().find(of_recipe)?;
    serde_json::from_value(record.document.value()).ok()
}

/// A recipe as it is kept in the session.
#[must_use]
pub fn recipe_record(session: &Session, recipe: &Recipe, now: Timestamp) -> ResultRecord {
    record(session, "Recipe of the import", recipe, now)
}

/// A session that begins with what was imported.
#[must_use]
pub fn session_of(name: &str, robot: Robot, imported: &Imported, now: Timestamp) -> Session {
    let mut session = Session::new(name, robot, now);
    session.measurements = imported.measurements.clone();
    session
}

/// Sources and a recipe to poses; the recipe goes without a name in messages, because it is on the screen.
///
/// # Errors
/// As [`tautline_import::import`].
pub fn cut(
    sources: &[Source],
    recipe: &Recipe,
    robot: &Robot,
) -> Result<Imported, tautline_import::ImportError> {
    import_sources(sources, recipe, "the recipe", robot)
}
