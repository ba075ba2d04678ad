//! TOML text converted to JSON values, so that both are read and checked alike.

use std::path::Path;

use serde_json::{Map, Value};
use tautline_core::effect::line_and_column;
use tautline_files::{Location, ReadError};

use super::{VersionedFile, check_size, read_limited, versioned_from};
use crate::error::Loaded;

/// Reads a versioned file in TOML.
///
/// # Errors
/// If the file cannot be read or is not valid for this type.
pub fn read_versioned_toml<T: VersionedFile>(path: &Path) -> Result<Loaded<T>, ReadError> {
    let file = path.display().to_string();
    parse_versioned_toml(&read_limited(path, &file, T::MAX_BYTES)?, &file)
}

/// Reads a versioned file in TOML from memory; `file` is the name for messages.
///
/// # Errors
/// If the bytes are not valid for this type.
pub fn parse_versioned_toml<T: VersionedFile>(
    bytes: &[u8],
    file: &str,
) -> Result<Loaded<T>, ReadError> {
    check_size(bytes, file, T::MAX_BYTES)?;
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let message = format!("found a byte that is not UTF-8 at {}", error.valid_up_to());
        ReadError::new(file, Location::File, message)
    })?;
    let document: Map<String, Value> =
        toml::from_str(text).map_err(|error| syntax(text, &error, file))?;
    versioned_from(document, file)
}

fn syntax(text: &str, error: &toml::de::Error, file: &str) -> ReadError {
    let message = format!("not valid TOML ({})", error.message().replace('\n', ", "));
    let place = error.span().map_or(Location::File, |span| {
        let (line, column) = line_and_column(text, span.start);
        Location::Character(line, column)
    });
    ReadError::new(file, place, message)
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::Robot;

    use super::*;

    fn refused(text: &str) -> String {
        let read = parse_versioned_toml::<Robot>(text.as_bytes(), "robot.toml");
        read.expect_err("refused").to_string()
    }

    #[test]
    fn mistakes_are_named_with_their_place() {
        let refused = [
            refused("format = \"tautline-robot\"\nversion = = 1\n"),
            refused("format = \"tautline-robot\"\nversion = 1\nname = 3\n"),
            refused("format = \"tautline-study\"\nversion = 1\n"),
        ];
        assert!(refused[0].starts_with("robot.toml, line 2, column 11: not valid TOML ("));
        assert_eq!(refused[1], "robot.toml, /name: found 3, expected a string");
        assert!(refused[2].ends_with("expected \"tautline-robot\""));
        assert!(refused.iter().all(|message| !message.contains('\n')));
    }
}
