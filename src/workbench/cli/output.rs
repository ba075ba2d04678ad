//! Where results go: a file written atomically, or standard output.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result};
use serde::Serialize;

/// Writes `value` as JSON to `target`; `-` is standard output.
pub fn write_json<T: Serialize>(target: &Path, value: &T) -> Result<()> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    if target == Path::new("-") {
        std::io::stdout().write_all(text.as_bytes())?;
        return Ok(());
    }
    tautline_session::write_text(target, &text)
        .with_context(|| format!("{} cannot be written", target.display()))
}

/// Whether the readable form should be printed: not where JSON goes to standard output.
pub fn is_readable(json: Option<&Path>) -> bool {
    json != Some(Path::new("-"))
}
