//! The lock of a session file.

use std::fs::{self, File, FileType, TryLockError};
use std::io::{Error as IoError, ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};

use same_file::Handle;
use tautline_session::link_target;

use crate::controllers::beside;

/// Suffix of the folder.
const UNSAVED: &str = ".unsaved";
/// Name of the locked file in the folder.
pub(super) const LOCK_NAME: &str = "lock";

/// The folder beside a session file with data that are not in the file yet. If `session` is a link, it is beside the
/// target, so that both ways of opening the session find the same folder.
#[must_use]
pub fn unsaved_folder(session: &Path) -> PathBuf {
    beside(&link_target(session), UNSAVED)
}

/// The lock of a session file: no other program changes the file as long as this value exists.
#[derive(Debug)]
pub struct FileLock {
    folder: PathBuf,
    /// The locked file; `None` only while this value is dropped.
    lock: Option<File>,
    /// The session file itself, so that it is locked under all its names; `None` if it does not exist yet, or cannot be locked
    /// on this system.
    session: Option<File>,
}

/// Reasons why a session file cannot be locked.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another program has locked it.
    #[error(
        "{}: another program is using this session; wait until it has ended, or save the session in the window where it is open",
        .0.display()
    )]
    Busy(PathBuf),
    /// The folder of the session file does not exist.
    #[error("{}: its folder does not exist", .0.display())]
    NoFolder(PathBuf),
    /// The lock cannot be created.
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
                // Another program has just removed the folder.
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                opened => opened.map_err(failed)?,
            };
            match file.try_lock() {
                Ok(()) if is_still(&file, &lock).map_err(failed)? => {
                    let mut held = Self {
                        folder,
                        lock: Some(file),
                        session: None,
                    };
                    held.session = lock_file(session)?;
                    return Ok(held);
                }
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(LockError::Busy(session.to_owned())),
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
        }
    }

    /// The folder with the unsaved data.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        // The file is removed while it is still locked, before another program can lock it.
        let _ = fs::remove_file(self.folder.join(LOCK_NAME));
        for lock in [self.session.take(), self.lock.take()]
            .into_iter()
            .flatten()
        {
            let _ = lock.unlock();
        }
        // Windows does not remove a folder in which a removed file is still open. A folder that contains unsaved poses, or the
        // lock of the next program, is not empty and therefore stays.
        let _ = fs::remove_dir(&self.folder);
    }
}

/// Locks a session file itself: hard links are several names of one file, beside each of which there could be a lock.
#[cfg(unix)]
fn lock_file(session: &Path) -> Result<Option<File>, LockError> {
    let Ok(file) = File::open(link_target(session)) else {
        // The error is reported when the session is read.
        return Ok(None);
    };
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Err(LockError::Busy(session.to_owned())),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// On systems where a locked file cannot be read, this program itself could not read it, either.
#[cfg(not(unix))]
fn lock_file(_: &Path) -> Result<Option<File>, LockError> {
    Ok(None)
}

/// Refuses links and anything else that this program did not create: a link would redirect the writing.
pub(super) fn check_own(path: &Path, is_ours: fn(&FileType) -> bool) -> IoResult<()> {
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

/// Whether an open file is still the one at `path`, which another program may have removed or replaced.
pub(super) fn is_still(file: &File, path: &Path) -> IoResult<bool> {
    match Handle::from_path(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        there => Ok(Handle::from_file(file.try_clone()?)? == there?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_of_a_lock() {
        let folder = tempfile::tempdir().expect("a folder");
        let session = folder.path().join("session.json");
        let held = FileLock::acquire(&session).expect("free");
        assert!(unsaved_folder(&session).exists());
        drop(held);
        assert!(!unsaved_folder(&session).exists());
        FileLock::acquire(&session).expect("free again");
    }

    #[test]
    fn a_lock_that_was_removed_or_replaced_is_another_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(LOCK_NAME);
        let held = File::create(&path).expect("a file");
        assert!(is_still(&held, &path).expect("compared"));
        fs::rename(&path, folder.path().join("aside")).expect("renamed");
        assert!(!is_still(&held, &path).expect("compared"));
        File::create(&path).expect("a file");
        assert!(!is_still(&held, &path).expect("compared"));
    }

    #[cfg(unix)]
    #[test]
    fn a_file_with_two_names_is_locked_under_both() {
        let folder = tempfile::tempdir().expect("a folder");
        let [one, two] = ["one.json", "two.json"].map(|name| folder.path().join(name));
        fs::write(&one, "{}").expect("written");
        fs::hard_link(&one, &two).expect("a link");
        let held = FileLock::acquire(&one).expect("free");
        let busy = FileLock::acquire(&two).expect_err("the same file");
        assert!(matches!(busy, LockError::Busy(path) if path == two));
        assert!(!unsaved_folder(&two).exists());
        drop(held);
        FileLock::acquire(&two).expect("free again");
    }
}
