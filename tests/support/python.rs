//! Programs of the tests in Python.

use std::path::Path;
use std::process::Command;

/// Runs a script of this repository by the Python of the tests.
///
/// # Panics
/// If its environment is missing.
#[must_use]
pub fn python(script: &str) -> Command {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let python = root.join("target/python/bin/python");
    assert!(
        python.exists(),
        "the Python environment of this test is missing: make it by bash .ci/python"
    );
    let mut command = Command::new(python);
    command.arg(root.join(script));
    command
}
