//! The file of the session that the window has open.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::OpenSession;
use tautline_workflow::session_file::{FileLock, LockError, unsaved_folder};

/// What distinguishes a file from one that was written later.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct FileStamp {
    modified: Option<SystemTime>,
    bytes: u64,
}

impl FileStamp {
    fn of(path: &Path) -> Option<Self> {
        let metadata = fs::metadata(path).ok()?;
        Some(Self {
            modified: metadata.modified().ok(),
            bytes: metadata.len(),
        })
    }
}

/// A file that was opened or saved here.
#[derive(Debug)]
struct Known {
    identity: u64,
    path: PathBuf,
    stamp: Option<FileStamp>,
}

/// Keeps commands from the file of the open session while it has unsaved changes, and the window from writing over what
/// a command wrote.
#[derive(Debug, Default)]
pub struct SessionLock {
    known: Option<Known>,
    held: Option<FileLock>,
    /// Revision at which it was tried to hold the file.
    tried: Option<u64>,
}

impl SessionLock {
    /// Holds the file while there are unsaved changes; one sentence where they cannot be saved in it.
    pub fn follow(&mut self, open: Option<&OpenSession>) -> Option<String> {
        let own = open.and_then(|open| Some((open, open.path()?)));
        let Some((open, path)) = own else {
            *self = Self::default();
            return None;
        };
        let identity = open.id();
        let is_known = |known: &Known| known.identity == identity && known.path == path;
        if !self.known.as_ref().is_some_and(is_known) {
            self.written(identity, path);
        }
        if !open.is_unsaved() {
            (self.held, self.tried) = (None, None);
            return None;
        }
        let is_new = self.tried.replace(open.revision()).is_none();
        if self.held.is_some() || !is_new {
            return None;
        }
        self.check(path).err()
    }

    /// Whether a path is that of the open session, kept from others.
    #[must_use]
    pub fn holds(&self, path: &Path) -> bool {
        self.held.is_some() && self.known.as_ref().is_some_and(|known| known.path == path)
    }

    /// Whether the session can be written to a file without losing what another program wrote.
    ///
    /// # Errors
    /// One sentence on why not.
    pub fn check(&mut self, path: &Path) -> Result<(), String> {
        let known = self.known.as_ref().filter(|known| known.path == path);
        let Some(known) = known else {
            return match unsaved_folder(path)
                .exists()
                .then(|| FileLock::acquire(path))
            {
                Some(Err(error @ LockError::Busy(_))) => Err(format!("{error}.")),
                _ => Ok(()),
            };
        };
        if self.held.is_none() {
            match FileLock::acquire(path) {
                Ok(held) => self.held = Some(held),
                Err(error @ LockError::Busy(_)) => return Err(format!("{error}.")),
                // Saving reports errors of the folder.
                Err(_) => {}
            }
        }
        match FileStamp::of(path) {
            Some(now) if Some(now) != known.stamp => Err(format!(
                "{}: another program has changed this session since it was opened; open it again, or save your changes under another name.",
                path.display()
            )),
            _ => Ok(()),
        }
    }

    /// The file was read or written just now.
    pub fn written(&mut self, identity: u64, path: &Path) {
        if !self.holds(path) {
            (self.held, self.tried) = (None, None);
        }
        self.known = Some(Known {
            identity,
            path: path.to_owned(),
            stamp: FileStamp::of(path),
        });
    }
}
