//! JSON documents with a `format` and a `version`: reading, migrating, writing, schemas.

mod explain;
pub(crate) mod migrate;
mod schema;
mod strict;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use tautline_core::robot::FieldError;

use crate::atomic::write_atomically;
use crate::error::{Loaded, Place, ReadError, WriteError};
pub(crate) use explain::kind;
pub use migrate::Migration;
pub use schema::{Schema, document_schema, schema_for};
pub(crate) use strict::parse as parse_object;

/// A type that is stored as a JSON document of its own.
pub trait Document: Serialize + DeserializeOwned + JsonSchema {
    /// Value of the key `format`.
    const FORMAT: &'static str;
    /// Value of the key `version` that this program writes.
    const VERSION: u32;
    /// Largest file that is read (bytes).
    const MAX_BYTES: u64;

    /// The steps from older versions to the present one.
    #[must_use]
    fn migrations() -> &'static [Migration] {
        &[]
    }

    /// Checks what the types alone do not guarantee.
    ///
    /// # Errors
    /// The first field that is wrong.
    fn check(&self) -> Result<(), FieldError>;
}

/// Reads a document from a file.
///
/// # Errors
/// If the file cannot be read or is not a valid document of this type.
pub fn read_document<T: Document>(path: &Path) -> Result<Loaded<T>, ReadError> {
    let file = path.display().to_string();
    let fail = |error| ReadError::io(&file, Place::File, &error);
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|f| f.take(T::MAX_BYTES + 1).read_to_end(&mut bytes))
        .map_err(fail)?;
    parse_document(&bytes, &file)
}

/// Reads a document from memory; `file` is the name for messages.
///
/// # Errors
/// If the bytes are not a valid document of this type.
pub fn parse_document<T: Document>(bytes: &[u8], file: &str) -> Result<Loaded<T>, ReadError> {
    if bytes.len() as u64 > T::MAX_BYTES {
        let message = format!("found more than {} MB, too large", T::MAX_BYTES >> 20);
        return Err(ReadError::new(file, Place::File, message));
    }
    document_in(strict::parse(bytes, file)?, file)
}

/// Makes a document of a JSON object that was parsed already.
pub(crate) fn document_in<T: Document>(
    mut document: Map<String, Value>,
    file: &str,
) -> Result<Loaded<T>, ReadError> {
    migrate::bring_up_to_date::<T>(&mut document, T::migrations(), file)?;
    let loaded = explain::deserialize::<T>(document, file)?;
    loaded
        .value
        .check()
        .map_err(|error| ReadError::field(file, error))?;
    Ok(loaded)
}

/// Writes a document to a file, atomically.
///
/// # Errors
/// If the value does not pass its own check or the file cannot be written.
pub fn write_document<T: Document>(path: &Path, value: &T) -> Result<(), WriteError> {
    let content = |message: String| WriteError::Content {
        path: path.into(),
        message,
    };
    value.check().map_err(|error| content(error.to_string()))?;
    let document = document(value);
    write_atomically(path, |out| {
        if T::MAX_BYTES > READABLE_BYTES {
            serde_json::to_writer(&mut *out, &document)?;
        } else {
            serde_json::to_writer_pretty(&mut *out, &document)?;
        }
        out.write_all(b"\n")
    })
}

/// The value as a document, ready to be serialised: `format` and `version` first.
pub fn document<T: Document>(value: &T) -> impl Serialize {
    Envelope {
        format: T::FORMAT,
        version: T::VERSION,
        body: value,
    }
}

/// Documents that can be larger than this are written without line breaks.
const READABLE_BYTES: u64 = 64 << 20;

/// The value as a document: `format` and `version` first.
#[derive(Serialize)]
struct Envelope<'a, T> {
    format: &'static str,
    version: u32,
    #[serde(flatten)]
    body: &'a T,
}
