//! Identification of files created by this program: only those are removed. A link is never one of them and never followed.

use std::ffi::OsStr;
use std::fs::{self, FileType};
use std::io::{Error as IoError, ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};

use super::{CHANGES, DISCARDED, FINISHED, JOURNAL, LOCK, ORIGIN, PREFIX, RESULTS, SNAPSHOT};
use crate::atomic::is_temporary;
use crate::error::WriteError;

/// Kind of an entry in a recovery folder, according to its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Name {
    /// The folder of an open or unsaved session.
    Session,
    /// The folder of a saved session that is being removed.
    Finished,
    /// The lock of either.
    Lock,
}

impl Name {
    /// The kind according to the name; `None` for names that this program does not use.
    pub fn of(name: &OsStr) -> Option<Self> {
        let (stem, extension) = match name.to_str()?.split_once('.') {
            Some((stem, extension)) => (stem, Some(extension)),
            None => (name.to_str()?, None),
        };
        let letters = stem.strip_prefix(PREFIX)?;
        if letters.is_empty() || !letters.bytes().all(|b| b.is_ascii_alphanumeric()) {
            return None;
        }
        match extension {
            None => Some(Self::Session),
            Some(FINISHED) => Some(Self::Finished),
            Some(LOCK) => Some(Self::Lock),
            Some(_) => None,
        }
    }
}

/// Whether `path` is a folder rather than a link.
pub(super) fn is_folder(path: &Path) -> bool {
    is_there(path, FileType::is_dir)
}

fn is_there(path: &Path, kind: impl Fn(&FileType) -> bool) -> bool {
    let found = fs::symlink_metadata(path).map(|found| found.file_type());
    found.is_ok_and(|found| kind(&found))
}

/// Rejects a link or anything else in place of a lock, as opening it would touch another file.
pub(super) fn check_lock(path: &Path) -> IoResult<()> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Ok(found) if found.is_file() => Ok(()),
        Ok(_) => Err(IoError::new(
            ErrorKind::InvalidInput,
            "it is a link or not a file, expected the lock file of this program",
        )),
        Err(error) => Err(error),
    }
}

/// Removes the recovery files of one session, and its folder if nothing else is in it.
pub(super) fn remove_session(folder: &Path) -> IoResult<()> {
    if !is_folder(folder) {
        return Ok(());
    }
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
        let is_known = [SNAPSHOT, JOURNAL, CHANGES, RESULTS, ORIGIN].contains(&name);
        if (is_known || is_temporary(name)) && is_there(&path, FileType::is_file) {
            fs::remove_file(&path)?;
        }
    }
    remove_if_empty(folder)
}

fn remove_if_empty(folder: &Path) -> IoResult<()> {
    match fs::remove_dir(folder) {
        Err(error) if error.kind() == ErrorKind::DirectoryNotEmpty => Ok(()),
        removed => removed,
    }
}

/// Removes the discarded sessions from a recovery folder, whose poses are in the session file by now, and the locks
/// of folders that a killed program created but did not use. Everything else stays.
///
/// # Errors
/// If a file of this program cannot be removed.
pub fn remove_discarded(folder: &Path) -> Result<(), WriteError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |error| WriteError::io(&path, error)
    };
    let aside = folder.join(DISCARDED);
    if is_folder(&aside) {
        for path in named(&aside, Name::Session).map_err(failed(&aside))? {
            remove_session(&path).map_err(failed(&path))?;
        }
        remove_if_empty(&aside).map_err(failed(&aside))?;
    }
    for path in named(folder, Name::Lock).map_err(failed(folder))? {
        if is_there(&path, FileType::is_file) {
            fs::remove_file(&path).map_err(failed(&path))?;
        }
    }
    Ok(())
}

/// Entries of a folder whose names are of this kind.
pub(super) fn named(folder: &Path, kind: Name) -> IoResult<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let paths: IoResult<Vec<PathBuf>> = entries.map(|entry| Ok(entry?.path())).collect();
    let is_named = |path: &PathBuf| path.file_name().and_then(Name::of) == Some(kind);
    Ok(paths?.into_iter().filter(is_named).collect())
}
