//! Descriptions of robots by other programs.

mod caspr;
mod description;
mod wirex;
mod xml;

use std::path::PathBuf;

use tautline_core::robot::Robot;
use tautline_session::{Loaded, Place, ReadError, open_input};

use xml::Element;

/// Largest description that is read (bytes).
const MAX_BYTES: u64 = 16 << 20;

/// Reads a robot description: the two files of cables and bodies of CASPR, or a model of WireX.
///
/// # Errors
/// If a file is none of these, or does not describe a robot with one platform.
pub fn read_robot_description(paths: &[PathBuf]) -> Result<Loaded<Robot>, ReadError> {
    let (mut cables, mut bodies) = (None, None);
    for path in paths {
        let file = path.display().to_string();
        let mut text = String::new();
        let input = open_input(path, &file)?;
        std::io::Read::read_to_string(&mut std::io::Read::take(input, MAX_BYTES), &mut text)
            .map_err(|error| ReadError::io(&file, Place::File, &error))?;
        let root = xml::parse(&text, &file)?;
        let slot = match root.name.as_str() {
            "cables" => &mut cables,
            "links" | "bodies_system" => &mut bodies,
            "models" => return wirex::robot(&file, &root),
            name => {
                let message = format!(
                    "found <{name}>, expected <cables> or <bodies_system> of CASPR or <models> of WireX"
                );
                return Err(ReadError::new(&file, Place::File, message));
            }
        };
        if let Some((first, _)) = &*slot {
            let message = format!(
                "describes the same part of a robot as {first}, expected one file of cables and one of bodies"
            );
            return Err(ReadError::new(&file, Place::File, message));
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
                Place::File,
                "describes bodies only, expected the file of the cables as well",
            ))
        }
    }
}

#[cfg(test)]
mod tests;
