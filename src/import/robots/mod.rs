//! Descriptions of robots by other programs.

mod caspr;
mod cdpr;
mod description;
mod dialect;
mod frames;
mod klipper;
mod maslow;
mod mujoco;
mod places;
mod reprap;
mod settings;
mod wirex;
mod xml;

use std::io::Read;
use std::path::{Path, PathBuf};

use tautline_core::robot::Robot;
use tautline_files::{Location, ReadError, open_input};
use tautline_session::Loaded;

pub use dialect::{Dialect, ForeignRobot, Meaning, Parameter, Setting};
pub use places::PartPlaces;
pub(crate) use places::places_of;

/// Largest description that is read (bytes).
const MAX_BYTES: u64 = 16 << 20;

impl Dialect {
    /// All dialects.
    pub const ALL: [&'static Self; 9] = [
        &reprap::DIALECT,
        &maslow::DIALECT,
        &klipper::DIALECT,
        &mujoco::DIALECT,
        &frames::URDF,
        &frames::SDF,
        &cdpr::DIALECT,
        &caspr::DIALECT,
        &wirex::DIALECT,
    ];

    /// The dialect of a text, or of its beginning.
    #[must_use]
    pub fn of(text: &str) -> Option<&'static Self> {
        Self::ALL.into_iter().find(|dialect| (dialect.is_in)(text))
    }
}

/// Whether a text, or its beginning, describes a robot.
pub(crate) fn is_description(text: &str) -> bool {
    Dialect::of(text).is_some() || xml::has_tag(text, "<links")
}

/// Reads a text file that describes a robot.
///
/// # Errors
/// If it cannot be read.
pub fn read_description_text(path: &Path) -> Result<String, ReadError> {
    let file = path.display().to_string();
    let mut text = String::new();
    let mut input = open_input(path, &file)?.take(MAX_BYTES);
    let read = input.read_to_string(&mut text);
    read.map_err(|error| ReadError::io(&file, Location::File, &error))?;
    Ok(text)
}

/// Reads a robot description: a text in one of the dialects, or the two files of cables and bodies of CASPR.
///
/// # Errors
/// If a file is none of these, or does not describe a robot with one platform.
pub(crate) fn read_described(paths: &[PathBuf]) -> Result<Loaded<Robot>, ReadError> {
    let (mut cables, mut bodies) = (None, None);
    for path in paths {
        let file = path.display().to_string();
        let text = read_description_text(path)?;
        if let Some(dialect) = Dialect::of(&text).filter(|one| one.bodies.is_none()) {
            if paths.len() > 1 {
                let message = "describes a whole robot, expected no other file beside it";
                return Err(ReadError::new(&file, Location::File, message));
            }
            let read = (dialect.read)(&file, &text)?;
            let (value, notices) = (read.robot, read.notices);
            return Ok(Loaded { value, notices });
        }
        let root = xml::parse(&text, &file)?;
        let slot = match root.name.as_str() {
            "cables" => &mut cables,
            "links" | "bodies_system" => &mut bodies,
            name => {
                let message = format!(
                    "found <{name}>, expected <robot> of URDF, <sdf>, <mujoco>, <cables> or <bodies_system> of CASPR or <models> of WireX"
                );
                return Err(ReadError::new(&file, Location::File, message));
            }
        };
        if let Some((first, _)) = &*slot {
            let message = format!(
                "describes the same part of a robot as {first}, expected one file of cables and one of bodies"
            );
            return Err(ReadError::new(&file, Location::File, message));
        }
        *slot = Some((file, root));
    }
    match cables {
        Some((file, cables)) => caspr::robot(
            &file,
            &cables,
            bodies.as_ref().map(|(file, root)| (file.as_str(), root)),
        ),
        None => {
            let file = bodies.map_or_else(String::new, |(file, _)| file);
            Err(ReadError::new(
                &file,
                Location::File,
                "describes bodies only, expected the file of the cables as well",
            ))
        }
    }
}

#[cfg(test)]
mod tests;
