//! Output of results: to a file, written atomically, or to standard output.

use std::borrow::Cow;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Result;
use serde::Serialize;
use tautline_session::VersionedFile;

/// Prints a line on standard output. A reader that stops reading (`tautline ... | head`) is not an error.
pub fn line(text: &str) {
    let _ = writeln!(std::io::stdout(), "{}", printable(text));
}

/// Prints a line on standard error.
pub fn notice(text: impl AsRef<str>) {
    let _ = writeln!(std::io::stderr(), "{}", printable(text.as_ref()));
}

/// Text with its control characters made visible: names of files and controllers can contain anything, and an escape
/// sequence in them could rewrite the terminal. Line ends and tabs stay.
fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_obeyed) {
        return text.into();
    }
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        match is_obeyed(letter) {
            true => shown.extend(letter.escape_unicode()),
            false => shown.push(letter),
        }
    }
    shown.into()
}

/// Whether a terminal may interpret a character instead of showing it, including marks that change the direction of
/// writing.
fn is_obeyed(letter: char) -> bool {
    let turns = matches!(letter, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || letter.is_control() && !matches!(letter, '\n' | '\t')
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
        line(&json_printable(text.trim_end()));
        return Ok(());
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
    fn control_characters_are_shown_and_not_obeyed() {
        let name = "PLC\u{1b}]0;owned\u{7}\u{1b}[2J\r\u{9b}1m\u{202e}";
        let shown = printable(name);
        assert_eq!(
            shown,
            r"PLC\u{1b}]0;owned\u{7}\u{1b}[2J\u{d}\u{9b}1m\u{202e}"
        );
        assert_eq!(printable("a\tb\nµ ± 1"), "a\tb\nµ ± 1");
    }

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
