//! Opening what is read.

use std::fs::{self, File};
use std::path::Path;

use crate::error::{Place, ReadError};

/// Opens a file for reading; `file` is its name for messages. A pipe or a device is refused: whoever reads one may wait
/// forever, and what comes out of it cannot be read twice.
///
/// # Errors
/// If it cannot be opened or is no file.
pub fn open_input(path: &Path, file: &str) -> Result<File, ReadError> {
    let failed = |error| ReadError::io(file, Place::File, &error);
    let kind = fs::metadata(path).map_err(failed)?.file_type();
    if !kind.is_file() && !kind.is_dir() {
        let message = "is a pipe or a device, expected a file";
        return Err(ReadError::new(file, Place::File, message));
    }
    File::open(path).map_err(failed)
}
