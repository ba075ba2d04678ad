//! Errors of reading files, each one sentence for the operator.

use std::borrow::Cow;
use std::fmt;

/// An error of reading a file, with its location.
///
/// Displays as one sentence on one line:
/// `poses.csv, line 12, column "rev_3": found "abc", expected a number`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}{place}: {}", OneLine(.file), OneLine(&shortened(.message, MESSAGE)))]
pub struct ReadError {
    /// The file as the operator named it.
    pub file: String,
    /// Location in the file.
    pub place: Location,
    /// Message: what was found, and what was expected.
    pub message: String,
}

/// A location in a file; lines and columns count from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Location {
    /// The file as a whole.
    File,
    /// A line of a text file.
    Line(u64),
    /// A cell of a CSV file: its line and the name of its column.
    Cell(u64, String),
    /// A character of a text file: line and column.
    Character(u64, u64),
    /// A JSON pointer, such as `/cables/3/pulley/radius_m`; empty for the file as a whole.
    Pointer(String),
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Cell(line, column) => write!(f, ", line {line}, column {}", quoted(column)),
            Self::Character(line, column) => write!(f, ", line {line}, column {column}"),
            Self::Pointer(pointer) if pointer.is_empty() => Ok(()),
            Self::Pointer(pointer) => {
                write!(f, ", {}", OneLine(&shortened(pointer, POINTER)))
            }
        }
    }
}

impl ReadError {
    /// An error at a location in `file`, under the name that the operator knows.
    #[must_use]
    pub fn new(file: &str, place: Location, message: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            place,
            message: message.into(),
        }
    }

    /// An error of the operating system, in words.
    #[must_use]
    pub fn io(file: &str, place: Location, error: &std::io::Error) -> Self {
        use std::io::ErrorKind;
        let message = match error.kind() {
            ErrorKind::NotFound => "not found".into(),
            ErrorKind::IsADirectory => "is a folder, expected a file".into(),
            ErrorKind::NotADirectory => "not found, a part of its path is a file".into(),
            ErrorKind::PermissionDenied => "cannot be read (permission denied)".into(),
            _ => format!("cannot be read ({})", OneLine(&error.to_string())),
        };
        Self::new(file, place, message)
    }
}

/// Length limit of a quotation from a file in a message (characters).
const QUOTED: usize = 40;
/// Length limit of a message (characters); only a quotation could make it longer.
const MESSAGE: usize = 500;
/// Length limit of a JSON pointer in a message (characters).
const POINTER: usize = 200;

/// Text from a file for use in a message: quoted, shortened, on one line.
#[must_use]
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", OneLine(&shortened(text, QUOTED)))
}

fn shortened(text: &str, limit: usize) -> Cow<'_, str> {
    match text.char_indices().nth(limit) {
        Some((end, _)) => format!("{}...", &text[..end]).into(),
        None => text.into(),
    }
}

/// Displays control characters escaped, so that a message stays on one line.
struct OneLine<'a>(&'a str);

impl fmt::Display for OneLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for c in self.0.chars() {
            if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') {
                write!(f, "{}", c.escape_default())?;
            } else {
                write!(f, "{c}")?;
            }
        }
        Ok(())
    }
}
