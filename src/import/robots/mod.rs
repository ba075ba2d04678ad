//! Descriptions of robots by other programs.

mod caspr;
mod xml;

use std::path::PathBuf;

use tautline_core::robot::Robot;
use tautline_session::{Loaded, Place, ReadError, open_input};

use xml::Element;

/// Largest description that is read (bytes).
const MAX_BYTES: u64 = 16 << 20;

/// Reads the robot that files describe: cables and bodies of CASPR, which are two files.
///
/// # Errors
/// If a file is none of these, or describes no robot with one platform.
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
            "links" | "bodies" | "body_system" => &mut bodies,
            // The meaning of its attributes is not published, and a guess would be a wrong robot.
            _ if root.find("chain").is_some() => {
                let message = "is a robot of WireX, which is not read, expected the cables of CASPR or a robot.json";
                return Err(ReadError::new(&file, Place::File, message));
            }
            name => {
                let message = format!("found <{name}>, expected <cables> or <links> of CASPR");
                return Err(ReadError::new(&file, Place::File, message));
            }
        };
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
                "describes bodies only, expected the file of the cables beside it",
            ))
        }
    }
}

#[cfg(test)]
mod tests;
