//! Output of results: to a file, written atomically, or to standard output.

use std::borrow::Cow;
use std::io::{ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use anyhow::{Result, anyhow};
use serde::Serialize;
use tautline_session::{ReservedFile, VersionedFile};
use tautline_workflow::wording::{is_obeyed, printable};

/// First error of writing to standard output.
static FAILURE: OnceLock<std::io::Error> = OnceLock::new();

/// Prints a line on standard output. An error, such as a full disk, is reported by [`check`].
pub fn line(text: &str) {
    note_failure(writeln!(stdout(), "{}", printable(text)));
}

/// Notes an error of writing to standard output for [`check`]. A reader that stops reading (`tautline ... | head`) is not an
/// error.
pub fn note_failure(written: std::io::Result<()>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        // Only the first error has a cause.
        let _ = FAILURE.set(error);
    }
}

/// Checks that everything has arrived on standard output.
pub fn check() -> Result<()> {
    note_failure(stdout().flush());
    match FAILURE.get() {
        None => Ok(()),
        Some(error) => Err(anyhow!("standard output: cannot be written ({error})")),
    }
}

/// Prints a line on standard error.
pub fn notice(text: impl AsRef<str>) {
    let _ = writeln!(std::io::stderr(), "{}", printable(text.as_ref()));
}

/// `println!` through [`line()`].
macro_rules! say {
    ($($text:tt)*) => {
        $crate::output::line(&format!($($text)*))
    };
}
pub(crate) use say;

/// `eprintln!` through [`notice()`].
macro_rules! note {
    ($($text:tt)*) => {
        $crate::output::notice(format!($($text)*))
    };
}
pub(crate) use note;

/// `--json`.
#[derive(Debug, clap::Args)]
pub struct JsonOutput {
    /// Write the results as JSON; - is standard output
    #[arg(id = "json", long, value_name = "FILE")]
    file: Option<PathBuf>,
}

impl JsonOutput {
    /// Whether standard output is for human-readable text, not JSON.
    pub fn is_text(&self) -> bool {
        self.file.as_deref() != Some(Path::new("-"))
    }

    /// Writes a document as JSON if requested, and prints the human-readable form.
    pub fn deliver<D: VersionedFile>(&self, document: &D, print: impl FnOnce()) -> Result<()> {
        self.open(0)?.deliver(document, print)
    }

    /// Opens the requested file, with space for the document and a result of at most [`RESULT`] bytes, before something is
    /// done that cannot be repeated.
    pub fn reserve<D: VersionedFile>(&self, document: &D) -> Result<ReservedOutput> {
        let text = pretty(&tautline_session::versioned(document))?;
        self.open(text.len() as u64 + RESULT)
    }

    fn open(&self, bytes: u64) -> Result<ReservedOutput> {
        let path = self.file.as_deref().filter(|_| self.is_text());
        let file = match path {
            Some(path) => Some(ReservedFile::create(path, bytes)?),
            None => None,
        };
        Ok(ReservedOutput {
            file,
            is_text: self.is_text(),
        })
    }
}

/// Largest growth of a document by its result (bytes).
const RESULT: u64 = 1 << 20;

/// Output for which there is space.
#[derive(Debug)]
pub struct ReservedOutput {
    /// `None` if no file was requested.
    file: Option<ReservedFile>,
    is_text: bool,
}

impl ReservedOutput {
    /// As [`JsonOutput::deliver`].
    pub fn deliver<D: VersionedFile>(self, document: &D, print: impl FnOnce()) -> Result<()> {
        let document = tautline_session::versioned(document);
        if let Some(file) = self.file {
            file.write_text(&pretty(&document)?)?;
        }
        match self.is_text {
            true => print(),
            false => write_json(Path::new("-"), &document)?,
        }
        check()
    }
}

fn pretty<T: Serialize>(value: &T) -> Result<String> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    Ok(text)
}

/// Writes `value` as JSON to `target`; `-` is standard output.
pub fn write_json<T: Serialize>(target: &Path, value: &T) -> Result<()> {
    let text = pretty(value)?;
    if target == Path::new("-") {
        line(&json_printable(text.trim_end()));
        return check();
    }
    Ok(tautline_session::write_text(target, &text)?)
}

/// Equivalent JSON with escapes for the characters that a terminal would interpret; all of them are in strings.
fn json_printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_obeyed) {
        return text.into();
    }
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match is_obeyed(letter) {
            true => safe.push_str(&format!("\\u{:04x}", u32::from(letter))),
            false => safe.push(letter),
        }
    }
    safe.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_on_a_terminal_means_the_same() {
        let name = "PLC\u{1b}[2J\u{7f}\u{9b}1m";
        let text = serde_json::to_string(name).expect("text");
        let shown = json_printable(&text);
        assert!(!shown.contains(is_obeyed), "{shown}");
        let read: String = serde_json::from_str(&shown).expect("JSON");
        assert_eq!(read, name);
    }
}
