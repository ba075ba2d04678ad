//! Errors of reading and writing files, each one sentence for the operator.

use std::borrow::Cow;
use std::fmt;
use std::path::{Path, PathBuf};

use tautline_core::robot::FieldError;

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
            Self::Pointer(pointer) => write!(f, ", {}", shown_pointer(pointer)),
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

    pub(crate) fn field(file: &str, error: FieldError) -> Self {
        Self::new(file, Location::Pointer(error.pointer), error.message)
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

/// Errors of writing a file.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system reported an error.
    #[error("{}: cannot be written ({error})", .path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system; not a source, because the message already contains it.
        error: std::io::Error,
    },
    /// The file exists and contains something else that must not be lost.
    #[error("{}: belongs to another dataset, expected an empty folder", .path.display())]
    OtherDataset {
        /// The file.
        path: PathBuf,
    },
    /// The content is not valid for the format, such as an infinite number.
    #[error("{}: {message}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Reason why the content cannot be written.
        message: String,
    },
}

impl WriteError {
    pub(crate) fn io(path: &Path, error: std::io::Error) -> Self {
        Self::Io {
            path: path.into(),
            error,
        }
    }
}

/// An error about a field with an invalid value.
pub(crate) fn fail<T>(
    pointer: impl Into<String>,
    message: impl Into<String>,
) -> Result<T, FieldError> {
    Err(FieldError {
        pointer: pointer.into(),
        message: message.into(),
    })
}

/// Moves the pointer of an error below `parent`, the pointer to the part in which it occurred.
pub(crate) fn below(parent: &str, error: FieldError) -> FieldError {
    FieldError {
        pointer: format!("{parent}{}", error.pointer),
        ..error
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

/// A JSON pointer for use in a message: shortened, on one line.
pub(crate) fn shown_pointer(pointer: &str) -> String {
    OneLine(&shortened(pointer, POINTER)).to_string()
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

/// A value read from a file, with notices for the operator.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded<T> {
    /// The value.
    pub value: T,
    /// One sentence each: unknown keys and columns, readings that no instrument explains.
    pub notices: Vec<String>,
}

impl<T> Loaded<T> {
    /// Converts the value and keeps the notices.
    #[must_use]
    pub fn map<U>(self, change: impl FnOnce(T) -> U) -> Loaded<U> {
        Loaded {
            value: change(self.value),
            notices: self.notices,
        }
    }
}
