//! The lock of a session file.

use std::fs::{self, File, Metadata, TryLockError};
use std::io::{Error as IoError, ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};

use crate::controllers::beside;

/// Ending of the folder.
const UNSAVED: &str = ".unsaved";
/// The file in it that is locked.
pub(super) const LOCK: &str = "lock";

/// The folder of what is not in a session file yet.
#[must_use]
pub fn folder_of(session: &Path) -> PathBuf {
    beside(session, UNSAVED)
}

/// A session file that nobody else changes while this value lives.
#[derive(Debug)]
pub struct Held {
    folder: PathBuf,
    lock: File,
}

/// Why a session file cannot be held.
#[derive(Debug, thiserror::Error)]
pub enum NotHeld {
    /// Another program does.
    #[error(
        "{}: another program works on this session at present; wait until it has ended, or save it in the window where it is open",
        .0.display()
    )]
    Busy(PathBuf),
    /// There is no such place.
    #[error("{}: its folder is not found", .0.display())]
    NoFolder(PathBuf),
    /// The lock cannot be made.
    #[error("{} cannot be written: {reason}", folder.display())]
    Io {
        /// The folder of the lock.
        folder: PathBuf,
        /// What the system says.
        reason: IoError,
    },
}

impl Held {
    /// Locks a session file.
    ///
    /// # Errors
    /// If another program has locked it, or nothing can be written beside it.
    pub fn take(session: &Path) -> Result<Self, NotHeld> {
        let folder = folder_of(session);
        let lock = folder.join(LOCK);
        let failed = |reason| NotHeld::Io {
            folder: folder.clone(),
            reason,
        };
        loop {
            match fs::create_dir(&folder) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    return Err(NotHeld::NoFolder(session.to_owned()));
                }
                made => made.map_err(failed)?,
            }
            let mut options = File::options();
            options.read(true).write(true).create(true).truncate(false);
            let file = match options.open(&lock) {
                // The other program has just removed the folder.
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                opened => opened.map_err(failed)?,
            };
            match file.try_lock() {
                Ok(()) if is_still(&file, &lock).map_err(failed)? => {
                    return Ok(Self { folder, lock: file });
                }
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(NotHeld::Busy(session.to_owned())),
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
        }
    }

    /// The folder of what is not in the file yet.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        // While it is locked; what stays behind is an empty folder or poses that are not in the file.
        let _ = fs::remove_file(self.folder.join(LOCK));
        let _ = fs::remove_dir(&self.folder);
        let _ = self.lock.unlock();
    }
}

/// Whether an open file is still the one at `path`, and not one that another program has removed meanwhile.
fn is_still(file: &File, path: &Path) -> IoResult<bool> {
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        there => Ok(is_same(&file.metadata()?, &there?)),
    }
}

#[cfg(unix)]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// Where files in use cannot be removed there is no other.
#[cfg(not(unix))]
fn is_same(_: &Metadata, _: &Metadata) -> bool {
    true
}
