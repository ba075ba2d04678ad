//! JSON files with a `format` and a `version`: reading, migrating, writing, schemas.

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

use crate::atomic::write_atomically;
use crate::error::{Loaded, Place, ReadError, WriteError};
use crate::input_file::open_input;
pub(crate) use explain::kind;
pub use migrate::Migration;
pub use schema::{Schema, schema_for, versioned_schema};
pub(crate) use strict::parse as parse_object;
pub use toml::{parse_versioned_toml, read_versioned_toml};

/// A type that is stored as a JSON file of its own, with its format and version.
pub trait VersionedFile: Serialize + DeserializeOwned + JsonSchema {
    /// Value of the key `format`.
    const FORMAT: &'static str;
    /// Value of the key `version` that this program writes.
    const VERSION: u32;
    /// Largest file that is read (bytes).
    const MAX_BYTES: u64;

    /// The steps from older versions to the present one.
    const MIGRATIONS: &'static [Migration] = &[];

    /// Puts values in the place of names that stand for them, before the types are built; by default nothing.
    ///
    /// # Errors
    /// The first field that is wrong.
    fn resolve(_document: &mut Map<String, Value>) -> Result<(), FieldError> {
        Ok(())
    }

    /// Allows in the schema of the type what [`Self::resolve`] replaces; by default nothing.
    fn amend_schema(_schema: &mut Value) {}

    /// Checks what the types alone do not guarantee; by default nothing.
    ///
    /// # Errors
    /// The first field that is wrong.
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

/// Reads at most one byte more than `limit`, which is enough for [`check_size`].
pub(crate) fn read_limited(path: &Path, file: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    open_input(path, file)?
        .take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| ReadError::io(file, Place::File, &error))?;
    Ok(bytes)
}

/// Refuses content of more than `limit` bytes.
pub(crate) fn check_size(bytes: &[u8], file: &str, limit: u64) -> Result<(), ReadError> {
    if bytes.len() as u64 <= limit {
        return Ok(());
    }
    let message = format!("found more than {} MB, too large", limit >> 20);
    Err(ReadError::new(file, Place::File, message))
}

/// Reads a versioned file from memory; `file` is the name for messages.
///
/// # Errors
/// If the bytes are not valid for this type.
pub fn parse_versioned<T: VersionedFile>(bytes: &[u8], file: &str) -> Result<Loaded<T>, ReadError> {
    check_size(bytes, file, T::MAX_BYTES)?;
    versioned_from(strict::parse(bytes, file)?, file)
}

/// Makes the value of a JSON object that was parsed already.
pub(crate) fn versioned_from<T: VersionedFile>(
    mut document: Map<String, Value>,
    file: &str,
) -> Result<Loaded<T>, ReadError> {
    migrate::bring_up_to_date::<T>(&mut document, T::MIGRATIONS, file)?;
    T::resolve(&mut document).map_err(|error| ReadError::field(file, error))?;
    let loaded = explain::deserialize::<T>(document, file)?;
    loaded
        .value
        .check()
        .map_err(|error| ReadError::field(file, error))?;
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

/// The value as it is stored, ready to be serialised: `format` and `version` first.
pub fn versioned<T: VersionedFile>(value: &T) -> impl Serialize {
    Envelope {
        format: T::FORMAT,
        version: T::VERSION,
        body: value,
    }
}

/// Files that can be larger than this are written without line breaks.
const READABLE_BYTES: u64 = 64 << 20;

/// A value after its `format` and `version`.
#[derive(Serialize)]
struct Envelope<'a, T> {
    format: &'static str,
    version: u32,
    #[serde(flatten)]
    body: &'a T,
}
