//! Errors of reading and writing files, each one sentence for the operator.

use std::path::{Path, PathBuf};

use tautline_core::robot::FieldError;
use tautline_files::{Location, ReadError};

/// An error about a field of `file`.
pub(crate) fn of_field(file: &str, error: FieldError) -> ReadError {
    ReadError::new(file, Location::Pointer(error.pointer), error.message)
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
