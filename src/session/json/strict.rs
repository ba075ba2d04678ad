//! Strict JSON parser that reports line and column of errors; a repeated key is an error.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};
use tautline_files::{Location, ReadError, quoted};

/// Parses a document, which must be an object.
pub(crate) fn parse(bytes: &[u8], file: &str) -> Result<Map<String, Value>, ReadError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| not_utf8(bytes, &error, file))?;
    if text.trim().is_empty() {
        let message = "found an empty file, expected a JSON object";
        return Err(ReadError::new(file, Location::File, message));
    }
    let value: Strict = serde_json::from_str(text).map_err(|error| syntax(&error, file))?;
    match value.0 {
        Value::Object(map) => Ok(map),
        other => {
            let message = format!(
                "found {}, expected a JSON object",
                super::explain::kind(&other)
            );
            Err(ReadError::new(file, Location::Character(1, 1), message))
        }
    }
}

fn not_utf8(bytes: &[u8], error: &std::str::Utf8Error, file: &str) -> ReadError {
    let before = &bytes[..error.valid_up_to()];
    let line = 1 + before.iter().filter(|byte| **byte == b'\n').count() as u64;
    let message = format!(
        "found the byte {:#04x}, expected UTF-8 text",
        bytes[error.valid_up_to()]
    );
    ReadError::new(file, Location::Line(line), message)
}

fn syntax(error: &serde_json::Error, file: &str) -> ReadError {
    let place = Location::Character(error.line() as u64, error.column() as u64);
    let text = error.to_string();
    let text = text.split(" at line ").next().unwrap_or_default();
    let message = if error.is_eof() {
        format!("the file is cut off ({text})")
    } else if error.is_data() {
        text.to_string()
    } else {
        format!("not valid JSON ({text})")
    };
    ReadError::new(file, place, message)
}

/// A JSON value without repeated keys in any object.
struct Strict(Value);

impl<'de> Deserialize<'de> for Strict {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StrictVisitor)
    }
}

struct StrictVisitor;

impl<'de> Visitor<'de> for StrictVisitor {
    type Value = Strict;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Strict, E> {
        Ok(Strict(value.into()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Strict, E> {
        Ok(Strict(value.into()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Strict, E> {
        Ok(Strict(value.into()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Strict, E> {
        Ok(Strict(
            Number::from_f64(value).map_or(Value::Null, Value::Number),
        ))
    }

    fn visit_str<E>(self, value: &str) -> Result<Strict, E> {
        Ok(Strict(value.into()))
    }

    fn visit_unit<E>(self) -> Result<Strict, E> {
        Ok(Strict(Value::Null))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Strict, A::Error> {
        let mut values = Vec::new();
        while let Some(Strict(value)) = sequence.next_element()? {
            values.push(value);
        }
        Ok(Strict(Value::Array(values)))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Strict, A::Error> {
        let mut map = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            if map.contains_key(&key) {
                let message = format!("found the key {} again, expected it once", quoted(&key));
                return Err(A::Error::custom(message));
            }
            let Strict(value) = entries.next_value()?;
            map.insert(key, value);
        }
        Ok(Strict(Value::Object(map)))
    }
}
