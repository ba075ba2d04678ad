//! Where results go: a file written atomically, or standard output.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result};
use serde::Serialize;

/// A line on standard output. A reader may stop reading (`tautline ... | head`), which is no error.
pub fn line(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// A line on standard error, beside the result.
pub fn notice(text: String) {
    eprintln!("{text}");
}

/// `println!` through [`line()`].
macro_rules! say {
    ($($text:tt)*) => {
        $crate::output::line(&format!($($text)*))
    };
}
pub(crate) use say;

/// Writes `value` as JSON to `target`; `-` is standard output.
pub fn write_json<T: Serialize>(target: &Path, value: &T) -> Result<()> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    if target == Path::new("-") {
        line(text.trim_end());
        return Ok(());
    }
    tautline_session::write_text(target, &text)
        .with_context(|| format!("{} cannot be written", target.display()))
}

/// Whether the readable form should be printed: not where JSON goes to standard output.
pub fn is_readable(json: Option<&Path>) -> bool {
    json != Some(Path::new("-"))
}
