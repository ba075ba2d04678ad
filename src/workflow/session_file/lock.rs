//! The lock of a session file.

use std::fs::{self, File, FileType, Metadata, TryLockError};
use std::io::{Error as IoError, ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};

use tautline_session::link_target;

use crate::controllers::beside;

/// Ending of the folder.
const UNSAVED: &str = ".unsaved";
/// The file in it that is locked.
pub(super) const LOCK_NAME: &str = "lock";

/// The folder beside a session file with what is not in the file yet; beside the file itself where `session` is a link to
/// it, so that whoever opens it either way finds the same.
#[must_use]
pub fn unsaved_folder(session: &Path) -> PathBuf {
    beside(&link_target(session), UNSAVED)
}

/// The lock of a session file: no other program changes the file while this value lives.
#[derive(Debug)]
pub struct FileLock {
    folder: PathBuf,
    lock: File,
}

/// Why a session file cannot be locked.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another program has locked it.
    #[error(
        "{}: another program is using this session; wait until it has ended, or save the session in the window where it is open",
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
        /// Reason given by the system.
        reason: IoError,
    },
}

impl FileLock {
    /// Locks a session file.
    ///
    /// # Errors
    /// If another program has locked it, or nothing can be written beside it.
    pub fn acquire(session: &Path) -> Result<Self, LockError> {
        let folder = unsaved_folder(session);
        let lock = folder.join(LOCK_NAME);
        let failed = |reason| LockError::Io {
            folder: folder.clone(),
            reason,
        };
        loop {
            match fs::create_dir(&folder) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    return Err(LockError::NoFolder(session.to_owned()));
                }
                made => made.map_err(failed)?,
            }
            check_own(&folder, FileType::is_dir).map_err(failed)?;
            check_own(&lock, FileType::is_file).map_err(failed)?;
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
                Err(TryLockError::WouldBlock) => return Err(LockError::Busy(session.to_owned())),
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
        }
    }

    /// The folder of what is not in the file yet.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        // The lock is released last. A folder with poses that are not in the file is not empty, so it stays.
        let _ = fs::remove_file(self.folder.join(LOCK_NAME));
        let _ = fs::remove_dir(&self.folder);
        let _ = self.lock.unlock();
    }
}

/// Refuses a link, or anything else than what this program makes at this place: what is written there would be elsewhere.
fn check_own(path: &Path, is_ours: fn(&FileType) -> bool) -> IoResult<()> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Ok(found) if is_ours(&found.file_type()) => Ok(()),
        Ok(_) => {
            let place = path.display();
            let text =
                format!("{place} is a link or something else that was not made by this program");
            Err(IoError::new(ErrorKind::InvalidInput, text))
        }
        Err(error) => Err(error),
    }
}

/// Whether an open file is still the one at `path`; another program may have removed it meanwhile.
fn is_still(file: &File, path: &Path) -> IoResult<bool> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        there => Ok(is_same(&file.metadata()?, &there?)),
    }
}

#[cfg(unix)]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// On systems where open files cannot be removed, it always is.
#[cfg(not(unix))]
fn is_same(_: &Metadata, _: &Metadata) -> bool {
    true
}
