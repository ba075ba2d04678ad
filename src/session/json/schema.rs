//! JSON Schemas of the files, generated from the types.

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use super::VersionedFile;

/// A JSON Schema and the name of the file it is published in.
#[derive(Debug, Clone, PartialEq)]
pub struct Schema {
    /// File name, such as `tautline-robot-1.schema.json`.
    pub file_name: String,
    /// The schema (JSON Schema, draft 2020-12).
    pub schema: Value,
}

/// The schema of any type, for reading.
#[must_use]
pub fn schema_for<T: JsonSchema>() -> Value {
    SchemaSettings::draft2020_12()
        .into_generator()
        .into_root_schema_for::<T>()
        .to_value()
}

/// The schema of a versioned file: that of its type plus the keys `format` and `version`.
#[must_use]
pub fn versioned_schema<T: VersionedFile>() -> Schema {
    let mut schema = schema_for::<T>();
    T::amend_schema(&mut schema);
    with_envelope(schema, T::FORMAT, T::VERSION)
}

fn with_envelope(mut schema: Value, format: &str, version: u32) -> Schema {
    let file_name = format!("{format}-{version}.schema.json");
    if let Some(object) = schema.as_object_mut() {
        object.insert(
            "title".into(),
            format!("{format}, version {version}").into(),
        );
        if let Some(Value::Object(properties)) = object.get_mut("properties") {
            properties.insert("format".into(), json!({"const": format}));
            properties.insert("version".into(), json!({"const": version}));
        }
        let required = object.entry("required").or_insert_with(|| json!([]));
        if let Value::Array(keys) = required {
            keys.splice(0..0, ["format".into(), "version".into()]);
        }
    }
    Schema { file_name, schema }
}
