//! Opening of input files.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use same_file::is_same_file;

use crate::error::{Location, ReadError};

/// Opens a file for reading; `file` is its name for messages. Pipes and devices are rejected, because reading one may block
/// forever, and their content cannot be read twice.
///
/// # Errors
/// If it cannot be opened or is not a file.
pub fn open_input(path: &Path, file: &str) -> Result<File, ReadError> {
    let failed = |error| ReadError::io(file, Location::File, &error);
    let kind = fs::metadata(path).map_err(failed)?.file_type();
    if !kind.is_file() && !kind.is_dir() {
        let message = "is a pipe or a device, expected a file";
        return Err(ReadError::new(file, Location::File, message));
    }
    let opened = File::open(path).map_err(failed)?;
    if let Ok(absolute) = std::path::absolute(path) {
        let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
        read.insert(absolute);
    }
    Ok(opened)
}

/// Files that this program has opened with [`open_input`].
static READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Whether a file was opened with [`open_input`] under any of its names: no output must replace it.
#[must_use]
pub fn was_read(path: &Path) -> bool {
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    read.iter()
        .any(|read| is_same_file(read, path).unwrap_or(false))
}
