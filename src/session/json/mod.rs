//! JSON files with the keys `format` and `version`: reading, migrating, writing, schemas.

mod explain;
pub(crate) mod migrate;
mod schema;
mod strict;
mod toml;

use std::io::Read;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use tautline_core::robot::FieldError;
use tautline_files::{Location, ReadError, open_input};

use crate::atomic::write_atomically;
use crate::error::{Loaded, WriteError, of_field};
pub(crate) use explain::kind;
pub use migrate::Migration;
pub use schema::{Schema, schema_for, versioned_schema};
pub(crate) use strict::parse as parse_object;
pub use toml::{parse_versioned_toml, read_versioned_toml};

/// A type stored as a JSON file with format and version.
pub trait VersionedFile: Serialize + DeserializeOwned + JsonSchema {
    /// Value of the key `format`.
    const FORMAT: &'static str;
    /// Value of the key `version` written by this program.
    const VERSION: u32;
    /// Largest file that is read (bytes).
    const MAX_BYTES: u64;

    /// Whether an unknown key is an error: people write the file, and a mistyped key would be ignored.
    const KEYS_ARE_CHECKED: bool = false;
    /// Migrations from older versions to the present one.
    const MIGRATIONS: &'static [Migration] = &[];

    /// Replaces references by the values they stand for, before the types are built; by default nothing.
    ///
    /// # Errors
    /// The first invalid field.
    fn resolve(_document: &mut Map<String, Value>) -> Result<(), FieldError> {
        Ok(())
    }

    /// Extends the schema of the type by what [`Self::resolve`] replaces; by default nothing.
    fn amend_schema(_schema: &mut Value) {}

    /// Checks conditions that the types do not guarantee; by default nothing.
    ///
    /// # Errors
    /// The first invalid field.
    fn check(&self) -> Result<(), FieldError> {
        Ok(())
    }
}

/// Reads a versioned file.
///
/// # Errors
/// If the file cannot be read or is not valid for this type.
pub fn read_versioned<T: VersionedFile>(path: &Path) -> Result<Loaded<T>, ReadError> {
    let file = path.display().to_string();
    parse_versioned(&read_limited(path, &file, T::MAX_BYTES)?, &file)
}

/// Reads at most one byte more than `limit`, as [`check_size`] needs.
pub(crate) fn read_limited(path: &Path, file: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    open_input(path, file)?
        .take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| ReadError::io(file, Location::File, &error))?;
    Ok(bytes)
}

/// Rejects content of more than `limit` bytes.
pub(crate) fn check_size(bytes: &[u8], file: &str, limit: u64) -> Result<(), ReadError> {
    if bytes.len() as u64 <= limit {
        return Ok(());
    }
    let message = format!("found more than {} MB, too large", limit >> 20);
    Err(ReadError::new(file, Location::File, message))
}

/// Reads a versioned file from memory; `file` is the name for messages.
///
/// # Errors
/// If the bytes are not valid for this type.
pub fn parse_versioned<T: VersionedFile>(bytes: &[u8], file: &str) -> Result<Loaded<T>, ReadError> {
    check_size(bytes, file, T::MAX_BYTES)?;
    versioned_from(strict::parse(bytes, file)?, file)
}

/// Builds the value from a parsed JSON object.
pub(crate) fn versioned_from<T: VersionedFile>(
    mut document: Map<String, Value>,
    file: &str,
) -> Result<Loaded<T>, ReadError> {
    migrate::bring_up_to_date::<T>(&mut document, T::MIGRATIONS, file)?;
    T::resolve(&mut document).map_err(|error| of_field(file, error))?;
    let loaded = explain::deserialize::<T>(document, file)?;
    loaded
        .value
        .check()
        .map_err(|error| of_field(file, error))?;
    Ok(loaded)
}

/// Writes a versioned file, atomically.
///
/// # Errors
/// If the value does not pass its own check or the file cannot be written.
pub fn write_versioned<T: VersionedFile>(path: &Path, value: &T) -> Result<(), WriteError> {
    let content = |message: String| WriteError::Content {
        path: path.into(),
        message,
    };
    value.check().map_err(|error| content(error.to_string()))?;
    let document = versioned(value);
    write_atomically(path, |out| {
        if T::MAX_BYTES > READABLE_BYTES {
            serde_json::to_writer(&mut *out, &document)?;
        } else {
            serde_json::to_writer_pretty(&mut *out, &document)?;
        }
        out.write_all(b"\n")
    })
}

/// The value in its stored form, ready to be serialised: `format` and `version` come first.
pub fn versioned<T: VersionedFile>(value: &T) -> impl Serialize {
    Envelope {
        format: T::FORMAT,
        version: T::VERSION,
        body: value,
    }
}

/// Largest possible file size up to which a type is written with line breaks.
const READABLE_BYTES: u64 = 64 << 20;

/// A value preceded by its `format` and `version`.
#[derive(Serialize)]
struct Envelope<'a> {
    format: &'static str,
    version: u32,
    #[serde(flatten)]
    body: &'a dyn erased_serde::Serialize,
}

/// A part of a file as a JSON value.
pub(crate) fn value_of(part: &dyn erased_serde::Serialize) -> Value {
    // Serialising fails only for keys that are not strings, and there are none.
    serde_json::to_value(part).unwrap_or(Value::Null)
}
