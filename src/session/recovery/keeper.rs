//! Keeps an open session safe while it is not saved.

use std::fs::{self, File};
use std::io::{Error as IoError, Result as IoResult};
use std::path::{Path, PathBuf};

use super::journal::{self, Entry};
use super::{FINISHED, JOURNAL, LOCK, PREFIX, SNAPSHOT, write_origin};
use crate::atomic::sync_folder;
use crate::error::WriteError;
use crate::session::{MeasuredPose, Session, write_session};

/// Holds on disk what an open session has and its file has not.
///
/// Dropped without [`Keeper::finish`], it leaves everything behind for
/// [`left_behind`](super::left_behind), as a crash does.
#[derive(Debug)]
pub struct Keeper {
    folder: PathBuf,
    lock: Lock,
    /// Poses of the journal.
    entries: Vec<Entry>,
}

/// A locked file; the operating system unlocks it when the program ends in whatever way.
#[derive(Debug)]
pub(super) struct Lock {
    pub file: File,
    pub path: PathBuf,
}

impl Keeper {
    /// Starts to keep a session that belongs to the file `origin`, in the recovery folder `folder`.
    ///
    /// # Errors
    /// If the files cannot be written.
    pub fn begin(
        folder: &Path,
        origin: Option<&Path>,
        session: &Session,
    ) -> Result<Self, WriteError> {
        let keeper = Self::start(folder).map_err(|error| WriteError::io(folder, error))?;
        write_origin(&keeper.folder, origin)?;
        journal::write(&keeper.folder.join(JOURNAL), std::iter::empty())?;
        write_session(&keeper.folder.join(SNAPSHOT), session)?;
        Ok(keeper)
    }

    /// The lock first: a folder without a locked lock is one that a crash has left behind.
    fn start(folder: &Path) -> IoResult<Self> {
        fs::create_dir_all(folder)?;
        let (file, path) = tempfile::Builder::new()
            .prefix(PREFIX)
            .suffix(&format!(".{LOCK}"))
            .tempfile_in(folder)?
            .keep()?;
        file.try_lock().map_err(IoError::from)?;
        let own = path.with_extension("");
        fs::create_dir(&own)?;
        sync_folder(folder)?;
        Ok(Self {
            folder: own,
            lock: Lock { file, path },
            entries: Vec::new(),
        })
    }

    /// Keeps the session as it is now. Poses in the journal that it does not have stay there.
    ///
    /// # Errors
    /// If the files cannot be written; what was kept before is still kept then.
    pub fn snapshot(&mut self, session: &Session) -> Result<(), WriteError> {
        write_session(&self.folder.join(SNAPSHOT), session)?;
        let has = |label: &i64| session.measurements.labels.contains(label);
        let mut entries = self.entries.clone();
        entries.retain(|entry| !entry.table.labels().iter().all(has));
        let path = self.folder.join(JOURNAL);
        let lines: IoResult<Vec<String>> = entries.iter().map(Entry::line).collect();
        let lines = lines.map_err(|error| WriteError::io(&path, error))?;
        journal::write(&path, lines.into_iter())?;
        self.entries = entries;
        Ok(())
    }

    /// Keeps one more measured pose; it is on disk when this returns.
    ///
    /// # Errors
    /// If the readings hold an infinite number or the journal cannot be written.
    pub fn measured(&mut self, pose: &MeasuredPose) -> Result<(), WriteError> {
        let path = self.folder.join(JOURNAL);
        let entry = Entry::of(pose);
        entry.table.check().map_err(|error| WriteError::Content {
            path: path.clone(),
            message: error.to_string(),
        })?;
        let line = entry.line();
        let line = line.map_err(|error| WriteError::io(&path, error))?;
        journal::append(&path, &line)?;
        self.entries.push(entry);
        Ok(())
    }

    /// The session belongs to the file `path` from now on.
    ///
    /// # Errors
    /// If that cannot be written down.
    pub fn moved_to(&self, path: &Path) -> Result<(), WriteError> {
        write_origin(&self.folder, Some(path))
    }

    /// Everything is saved: removes the files.
    ///
    /// # Errors
    /// If they cannot be removed.
    pub fn finish(self) -> Result<(), WriteError> {
        // Renamed first, so that a kill between leaves nothing that looks like a crash.
        let finished = self.folder.with_extension(FINISHED);
        fs::rename(&self.folder, &finished)
            .and_then(|()| fs::remove_dir_all(&finished))
            .and_then(|()| self.lock.remove())
            .map_err(|error| WriteError::io(&self.folder, error))
    }
}

impl Lock {
    /// Removes the file, whose folder is no longer there, and unlocks it.
    pub fn remove(self) -> IoResult<()> {
        let removed = fs::remove_file(&self.path);
        drop(self.file);
        removed
    }
}
