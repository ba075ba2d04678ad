//! `robot.json` and model files: the same format; a model has effects. The laser may refer to a sensor of the catalogue.

use std::path::Path;

use serde_json::{Map, Value, json};
use tautline_core::robot::{FieldError, Robot};
use tautline_files::{Location, ReadError};

use crate::error::{Loaded, WriteError};
use crate::json::{VersionedFile, parse_versioned, read_limited, read_versioned, write_versioned};
use crate::sensors::resolve_in_robot;
use crate::session::Timestamp;

impl VersionedFile for Robot {
    const FORMAT: &'static str = "tautline-robot";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
    const KEYS_ARE_CHECKED: bool = true;

    fn resolve(document: &mut Map<String, Value>) -> Result<(), FieldError> {
        // It belongs to the readings, not to the robot: see `read_measured_at`.
        document.remove(MEASURED_AT);
        resolve_in_robot(document)
    }

    fn amend_schema(schema: &mut Value) {
        schema["properties"][MEASURED_AT] = json!({
            "type": ["string", "null"],
            "format": "date-time",
            "description": "When the poses of the dataset were read."
        });
        if let Some(laser) = schema.pointer_mut("/$defs/Laser") {
            laser["properties"]["sensor"] = json!({
                "type": "string",
                "description": "Sensor of the catalogue, instead of `sd_m`."
            });
            if let Some(Value::Array(required)) = laser.get_mut("required") {
                required.retain(|key| key != "sd_m");
            }
            laser["oneOf"] = json!([{"required": ["sd_m"]}, {"required": ["sensor"]}]);
        }
    }

    fn check(&self) -> Result<(), FieldError> {
        Self::check(self)
    }
}

/// Key of the time when the poses of a dataset were read.
const MEASURED_AT: &str = "measured_at";

/// Time at which the poses of a dataset were read, if its `robot.json` states it.
///
/// # Errors
/// If the file cannot be read or the time is none.
pub(crate) fn read_measured_at(path: &Path) -> Result<Option<Timestamp>, ReadError> {
    let file = path.display().to_string();
    let bytes = read_limited(path, &file, Robot::MAX_BYTES)?;
    let document: Value =
        serde_json::from_slice(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes))
            .unwrap_or_default();
    match &document[MEASURED_AT] {
        Value::Null => Ok(None),
        Value::String(text) if let Ok(time) = text.parse::<jiff::Timestamp>() => {
            Ok(Some(Timestamp::from_unix_seconds(time.as_second())))
        }
        other => Err(ReadError::new(
            &file,
            Location::Pointer(format!("/{MEASURED_AT}")),
            format!(
                "found {other}, expected a time as in RFC 3339, such as \"2026-03-12T09:30:00Z\""
            ),
        )),
    }
}

/// Reads a `robot.json` or model file.
///
/// # Errors
/// If the file cannot be read or does not describe a possible robot.
pub fn read_robot(path: &Path) -> Result<Loaded<Robot>, ReadError> {
    read_versioned(path)
}

/// Reads a robot from memory; `file` is the name for messages.
///
/// # Errors
/// If the bytes do not describe a possible robot.
pub fn parse_robot(bytes: &[u8], file: &str) -> Result<Loaded<Robot>, ReadError> {
    parse_versioned(bytes, file)
}

/// Writes a `robot.json` or model file, atomically.
///
/// # Errors
/// If the robot is not possible or the file cannot be written.
pub fn write_robot(path: &Path, robot: &Robot) -> Result<(), WriteError> {
    write_versioned(path, robot)
}
