//! Where results go: a file written atomically, or standard output.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Serialize;
use tautline_session::VersionedFile;

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

/// `--json`.
#[derive(Debug, clap::Args)]
pub struct JsonOutput {
    /// Write the results as JSON; - is standard output
    #[arg(id = "json", long, value_name = "FILE")]
    file: Option<PathBuf>,
}

impl JsonOutput {
    /// Whether readable text goes to standard output, and not JSON.
    pub fn is_text(&self) -> bool {
        self.file.as_deref() != Some(Path::new("-"))
    }

    /// Writes a document as JSON where it was asked for, and prints the readable form.
    pub fn deliver<D: VersionedFile>(&self, document: &D, print: impl FnOnce()) -> Result<()> {
        if let Some(path) = &self.file {
            write_json(path, &tautline_session::versioned(document))?;
        }
        if self.is_text() {
            print();
        }
        Ok(())
    }
}

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
