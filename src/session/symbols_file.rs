//! Files with the symbol names of a controller.

use std::path::Path;

use tautline_core::robot::Robot;
use tautline_files::ReadError;

use crate::error::{Loaded, WriteError, of_field};
use crate::json::{parse_versioned, read_versioned, write_versioned};
use crate::session::SymbolMapping;

/// Reads the symbols of an ADS controller, and checks that they fit a robot.
///
/// # Errors
/// If the file cannot be read, or its symbols do not fit this robot.
pub fn read_symbols(path: &Path, robot: &Robot) -> Result<Loaded<SymbolMapping>, ReadError> {
    fitting(read_versioned(path)?, &path.display().to_string(), robot)
}

/// Reads symbols from memory, and checks that they fit a robot; `file` is the name for messages.
///
/// # Errors
/// If the bytes are no symbols, or these do not fit this robot.
pub fn parse_symbols(
    bytes: &[u8],
    file: &str,
    robot: &Robot,
) -> Result<Loaded<SymbolMapping>, ReadError> {
    fitting(parse_versioned(bytes, file)?, file, robot)
}

fn fitting(
    read: Loaded<SymbolMapping>,
    file: &str,
    robot: &Robot,
) -> Result<Loaded<SymbolMapping>, ReadError> {
    let checked = read.value.check(robot);
    checked.map_err(|error| of_field(file, error))?;
    Ok(read)
}

/// Writes symbols atomically.
///
/// # Errors
/// If the file cannot be written.
pub fn write_symbols(path: &Path, mapping: &SymbolMapping) -> Result<(), WriteError> {
    write_versioned(path, mapping)
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;

    #[test]
    fn symbols_read_back_and_a_wrong_one_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("symbols.json");
        let robot = presets::find("mini").expect("a preset").robot;
        let mut mapping = SymbolMapping::default_for(&robot);
        write_symbols(&path, &mapping).expect("written");
        assert_eq!(read_symbols(&path, &robot).expect("read").value, mapping);
        let error = |text: &str| {
            std::fs::write(&path, text).expect("written");
            let error = read_symbols(&path, &robot).expect_err("wrong");
            error.to_string()
        };
        let text = std::fs::read_to_string(&path).expect("a file");
        let told = error(&text.replace("tautline-symbols", "tautline-robot"));
        assert!(told.contains("symbols.json"), "{told}");
        let told = error(&text.replacen("1.0", "\"one\"", 1));
        assert!(told.contains("/readings/revolutions/scale"), "{told}");
        mapping.readings.revolutions.scale = 0.0;
        write_symbols(&path, &mapping).expect("written");
        let told = read_symbols(&path, &robot).expect_err("no scale");
        let told = told.to_string();
        assert!(
            told.contains("/readings/revolutions/scale: found 0"),
            "{told}"
        );
        let other = presets::find("planar").expect("a preset").robot;
        mapping.readings.revolutions.scale = 1.0;
        mapping.readings.revolutions.symbol =
            crate::session::SymbolNames::Each((0..8).map(|k| format!("turns{k}")).collect());
        write_symbols(&path, &mapping).expect("written");
        assert!(read_symbols(&path, &robot).is_ok());
        let told = read_symbols(&path, &other).expect_err("other cables");
        assert!(told.to_string().contains("found 8 names"), "{told}");
    }
}
