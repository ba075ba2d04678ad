//! Conversion of JSON values to types, with errors in terms of the format rather than of Rust.

use std::collections::BTreeSet;

use serde_json::{Map, Value};
use serde_path_to_error::{Path, Segment, Track};
use tautline_files::{Location, ReadError, quoted};

use super::{VersionedFile, versioned_schema};
use crate::error::Loaded;

/// Largest number of unknown keys that are listed; more are only counted.
const MAX_NOTICES: usize = 20;

/// Key that names the schema of a file for editors.
const SCHEMA: &str = "$schema";
/// Similarity from which a key is suggested, as for the options of commands.
const SIMILAR: f64 = 0.8;

/// Builds the type; unknown keys become notices, or the first is an error where keys are checked.
pub(super) fn deserialize<T: VersionedFile>(
    mut document: Map<String, Value>,
    file: &str,
) -> Result<Loaded<T>, ReadError> {
    document.remove(SCHEMA);
    let mut unknown = Vec::new();
    let mut note = |path: serde_ignored::Path<'_>| unknown.push(pointer_of_ignored(&path));
    let mut track = Track::new();
    let document = Value::Object(document);
    let result: Result<T, _> = {
        let tracked = serde_path_to_error::Deserializer::new(&document, &mut track);
        let noted = serde_ignored::Deserializer::new(tracked, &mut note);
        // Otherwise each type would be compiled anew for each place in a file at which it occurs.
        erased_serde::deserialize(&mut <dyn erased_serde::Deserializer<'_>>::erase(noted))
    };
    match result {
        Ok(_) if T::KEYS_ARE_CHECKED && !unknown.is_empty() => {
            let pointer = unknown.swap_remove(0);
            let message = unknown_key::<T>(&pointer);
            Err(ReadError::new(file, Location::Pointer(pointer), message))
        }
        Ok(value) => Ok(Loaded {
            value,
            notices: notices(&unknown, file),
        }),
        Err(error) => {
            let pointer = pointer(&track.path());
            let message = message(&error.to_string(), document.pointer(&pointer));
            Err(ReadError::new(file, Location::Pointer(pointer), message))
        }
    }
}

/// The error about an unknown key, with the nearest key of the format.
fn unknown_key<T: VersionedFile>(pointer: &str) -> String {
    let key = pointer.rsplit('/').next().unwrap_or_default();
    let mut keys = BTreeSet::new();
    keys_of(&versioned_schema::<T>().schema, &mut keys);
    let likeness = |known: &String| strsim::jaro_winkler(key, known);
    let nearest = keys
        .iter()
        .max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
        .filter(|known| likeness(known) >= SIMILAR);
    match nearest {
        Some(known) if known == key => "unknown here, expected elsewhere in this file".to_owned(),
        Some(known) => format!("unknown key, did you mean {}?", quoted(known)),
        None => "unknown key, expected one of the format (tautline schemas --out DIR writes it)"
            .to_owned(),
    }
}

/// Names of all properties in a schema.
fn keys_of(schema: &Value, keys: &mut BTreeSet<String>) {
    match schema {
        Value::Object(members) => {
            if let Some(Value::Object(properties)) = members.get("properties") {
                keys.extend(properties.keys().cloned());
            }
            members.values().for_each(|member| keys_of(member, keys));
        }
        Value::Array(items) => items.iter().for_each(|item| keys_of(item, keys)),
        _ => {}
    }
}

fn notices(unknown: &[String], file: &str) -> Vec<String> {
    let shown = unknown.iter().take(MAX_NOTICES);
    let mut notices: Vec<String> = shown
        .map(|pointer| {
            format!(
                "{file}{}: unknown key, ignored",
                Location::Pointer(pointer.clone())
            )
        })
        .collect();
    if unknown.len() > MAX_NOTICES {
        let more = unknown.len() - MAX_NOTICES;
        notices.push(format!("{file}: {more} more unknown keys, ignored"));
    }
    notices
}

fn pointer(path: &Path) -> String {
    let mut pointer = String::new();
    for segment in path {
        match segment {
            Segment::Seq { index } => push(&mut pointer, &index.to_string()),
            Segment::Map { key } => push(&mut pointer, key),
            Segment::Enum { .. } | Segment::Unknown => {}
        }
    }
    pointer
}

fn pointer_of_ignored(path: &serde_ignored::Path<'_>) -> String {
    use serde_ignored::Path as P;
    let (parent, key) = match path {
        P::Root => return String::new(),
        P::Seq { parent, index } => (parent, index.to_string()),
        P::Map { parent, key } => (parent, key.clone()),
        P::Some { parent } | P::NewtypeStruct { parent } | P::NewtypeVariant { parent } => {
            return pointer_of_ignored(parent);
        }
    };
    let mut pointer = pointer_of_ignored(parent);
    push(&mut pointer, &key);
    pointer
}

fn push(pointer: &mut String, key: &str) {
    pointer.push('/');
    pointer.push_str(&key.replace('~', "~0").replace('/', "~1"));
}

/// The error in terms of the format: what was found, what was expected.
fn message(error: &str, found: Option<&Value>) -> String {
    if let Some(key) = error.strip_prefix("missing field ") {
        return format!("has no key {}, expected one", key.replace('`', "\""));
    }
    // A mistake in a text with lines of its own, such as a hypothesis, is a sentence already.
    if error.starts_with("line ") {
        return error.to_owned();
    }
    let found = found.map_or_else(|| "nothing".into(), kind);
    match error.rsplit_once("expected ") {
        Some((_, expected)) => format!("found {found}, expected {}", plain(expected)),
        None => format!("found {found}: {error}"),
    }
}

/// Plain words for serde's name of a Rust type.
fn plain(expected: &str) -> String {
    match expected {
        "f64" => "a number".into(),
        "usize" | "u64" | "u32" => "a whole number, not negative".into(),
        "i64" => "a whole number".into(),
        "a sequence" => "an array".into(),
        "a map" => "an object".into(),
        _ if expected.starts_with("struct ") => "an object".into(),
        _ => match expected.strip_prefix("an array of length ") {
            Some(length) => format!("an array of {length}"),
            None => expected.replace('`', "\""),
        },
    }
}

/// A JSON value in a few words.
pub(crate) fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Bool(value) => value.to_string(),
        Value::Number(value) => value.to_string(),
        Value::String(value) => quoted(value),
        Value::Array(values) => format!("an array of {}", values.len()),
        Value::Object(_) => "an object".into(),
    }
}
