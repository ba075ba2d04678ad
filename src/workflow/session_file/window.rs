//! Mark of the window in which a session is open.

use std::fs::{self, File, FileType, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use tautline_session::{Fingerprint, Timestamp, link_target};

use super::lock::{check_own, is_still};

/// The mark of the window in which a session is open: a locked empty file in a folder of the user, created when the session was
/// opened. It is not beside the session, which can be shared, read-only, or listed with others.
#[derive(Debug)]
pub struct OpenWindow {
    mark: PathBuf,
    file: File,
}

/// The mark of a session file, the same for every path that leads to the file.
fn mark_of(windows: &Path, session: &Path) -> PathBuf {
    let target = link_target(session);
    let target = fs::canonicalize(&target).unwrap_or(target);
    windows.join(Fingerprint::of(target.to_string_lossy().as_bytes()).to_hex())
}

/// Modification time of a file that another program has locked.
fn made(mark: &Path) -> Timestamp {
    let modified = fs::metadata(mark).and_then(|found| found.modified());
    let since = modified.unwrap_or_else(|_| SystemTime::now());
    let since = since.duration_since(UNIX_EPOCH).unwrap_or_default();
    Timestamp::from_unix_seconds(since.as_secs().try_into().unwrap_or(i64::MAX))
}

impl OpenWindow {
    /// Marks a session as open here, in the folder of marks; without a mark if none can be created.
    /// # Errors
    /// The time since when the session is open in another window.
    pub fn enter(windows: &Path, session: &Path) -> Result<Option<Self>, Timestamp> {
        let mark = mark_of(windows, session);
        // Opening the mark fails without the folder.
        let _ = fs::create_dir_all(windows);
        loop {
            let mut options = File::options();
            options.write(true).create(true).truncate(false);
            let opened = check_own(&mark, FileType::is_file).and_then(|()| options.open(&mark));
            let Ok(file) = opened else {
                return Ok(None);
            };
            match file.try_lock() {
                Ok(()) if is_still(&file, &mark).unwrap_or(false) => {
                    // The file may be left over from a killed program.
                    let _ = file.set_modified(SystemTime::now());
                    return Ok(Some(Self { mark, file }));
                }
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(made(&mark)),
                Err(TryLockError::Error(_)) => return Ok(None),
            }
        }
    }

    /// Like [`Self::enter`], but the other window sees afterwards that the session [is no longer its own](Self::is_ours).
    /// # Errors
    /// The time since when the session is open in another window, if its mark cannot be removed.
    pub fn take_over(windows: &Path, session: &Path) -> Result<Option<Self>, Timestamp> {
        let mark = mark_of(windows, session);
        let is_mark =
            fs::symlink_metadata(&mark).is_ok_and(|there| there.is_file() && there.len() == 0);
        if is_mark {
            // If the mark cannot be removed, `enter` returns the error.
            let _ = fs::remove_file(&mark);
        }
        Self::enter(windows, session)
    }

    /// Whether no other window has taken the session over.
    #[must_use]
    pub fn is_ours(&self) -> bool {
        is_still(&self.file, &self.mark).unwrap_or(false)
    }

    /// Whether this is the mark of a session.
    #[must_use]
    pub fn is_of(&self, session: &Path) -> bool {
        let windows = self.mark.parent().unwrap_or(&self.mark);
        self.mark == mark_of(windows, session)
    }
}

impl Drop for OpenWindow {
    fn drop(&mut self) {
        if self.is_ours() {
            let _ = fs::remove_file(&self.mark);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_is_open_in_one_window_until_another_takes_it_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let (windows, session) = (folder.path().join("windows"), folder.path().join("s.json"));
        let enter = || OpenWindow::enter(&windows, &session);
        let first = enter().expect("free").expect("a mark");
        assert!(first.is_ours() && first.is_of(&session));
        let since = enter().expect_err("it is open").unix_seconds();
        assert!((since - crate::clock::now().unix_seconds()).abs() < 60);
        let second = OpenWindow::take_over(&windows, &session);
        let second = second.expect("taken").expect("a mark");
        assert!(second.is_ours() && !first.is_ours());
        // The window that lost the session does not remove the mark of the other one.
        drop(first);
        enter().expect_err("it is open");
        drop(second);
        assert!(windows.read_dir().expect("a folder").next().is_none());
    }
}
