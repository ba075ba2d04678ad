//! Opening of input files.

use std::fs::{self, File};
use std::path::Path;

use crate::error::{Place, ReadError};

/// Opens a file for reading; `file` is its name for messages. Pipes and devices are rejected, because reading one may block
/// forever, and their content cannot be read twice.
///
/// # Errors
/// If it cannot be opened or is not a file.
pub fn open_input(path: &Path, file: &str) -> Result<File, ReadError> {
    let failed = |error| ReadError::io(file, Place::File, &error);
    let kind = fs::metadata(path).map_err(failed)?.file_type();
    if !kind.is_file() && !kind.is_dir() {
        let message = "is a pipe or a device, expected a file";
        return Err(ReadError::new(file, Place::File, message));
    }
    File::open(path).map_err(failed)
}
