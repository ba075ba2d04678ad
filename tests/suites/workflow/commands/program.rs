//! Checks of the output of the built program.

use serde_json::Value;
pub use tautline_validation::support::program::{Answer, Folder, tautline};

/// Asserts that the document satisfies the schema that the program publishes for it.
pub fn assert_valid(document: &Value) {
    let folder = Folder::new();
    tautline(&["schemas", "--out", &folder.join("s")]).succeeded();
    let format = document["format"].as_str().expect("a format");
    let schema = folder.json(&format!("s/{format}-1.schema.json"));
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let errors = validator.iter_errors(document).map(|e| e.to_string());
    let errors: Vec<String> = errors.collect();
    assert!(errors.is_empty(), "{errors:?}");
}

/// A number in a document.
pub fn number(document: &Value, pointer: &str) -> f64 {
    let value = document.pointer(pointer).and_then(Value::as_f64);
    value.unwrap_or_else(|| panic!("no number {pointer} in {document}"))
}

/// Asserts the value of a number in a document.
pub fn assert_number(document: &Value, pointer: &str, expected: f64, tolerance: f64) {
    let found = number(document, pointer);
    assert!(
        (found - expected).abs() <= tolerance,
        "{pointer} is {found}, not {expected}"
    );
}
