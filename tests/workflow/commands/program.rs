//! The built program and what it answers.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tautline_validation::program::program;
use tempfile::TempDir;

/// What a run of the program left behind.
pub struct Answer {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Answer {
    /// Insists on success.
    pub fn succeeded(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    /// Insists on bad input: exit code 2, nothing on standard output, one sentence with these parts.
    pub fn refused(&self, parts: &[&str]) {
        assert_eq!(self.code, Some(2), "{}{}", self.stdout, self.stderr);
        assert_eq!(self.stdout, "");
        assert_eq!(self.stderr.lines().count(), 1, "{}", self.stderr);
        assert!(self.stderr.ends_with('\n'));
        for part in parts {
            assert!(self.stderr.contains(part), "{} lacks {part}", self.stderr);
        }
    }

    /// Standard output, all of it, as JSON.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).expect("nothing but JSON on standard output")
    }
}

/// Runs the program.
pub fn tautline(arguments: &[&str]) -> Answer {
    let output = Command::new(program()).args(arguments).output();
    let output = output.expect("the program starts");
    Answer {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).expect("UTF-8"),
        stderr: String::from_utf8(output.stderr).expect("UTF-8"),
    }
}

/// A folder with paths in it as text.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn join(&self, name: &str) -> String {
        self.path().join(name).to_str().expect("UTF-8").to_owned()
    }

    pub fn write(&self, name: &str, text: &str) -> String {
        std::fs::write(self.path().join(name), text).expect("written");
        self.join(name)
    }

    /// A JSON file in it.
    pub fn json(&self, name: &str) -> Value {
        let text = std::fs::read_to_string(self.path().join(name)).expect("a file");
        serde_json::from_str(&text).expect("JSON")
    }
}

/// Insists that the document satisfies the schema that the program publishes for it.
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

/// Insists that a number in a document is this one.
pub fn assert_number(document: &Value, pointer: &str, expected: f64, tolerance: f64) {
    let found = number(document, pointer);
    assert!(
        (found - expected).abs() <= tolerance,
        "{pointer} is {found}, not {expected}"
    );
}
