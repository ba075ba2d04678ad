//! Keeps an open session safe while it is not saved.

use std::fs::{self, File};
use std::io::{Error as IoError, Result as IoResult};
use std::path::{Path, PathBuf};

use tautline_core::robot::FieldError;

use super::changes::Changes;
use super::journal::{self, Entry, Journal};
use super::{CHANGES, FINISHED, JOURNAL, LOCK, PREFIX, RESULTS, SNAPSHOT, results, write_origin};
use crate::atomic::sync_folder;
use crate::error::WriteError;
use crate::fingerprint::Fingerprint;
use crate::json::write_document;
use crate::poses::Columns;
use crate::session::{MeasuredPose, Session, write_session};

/// Holds on disk what an open session has and its file has not.
///
/// Dropped without [`Keeper::finish`], it leaves everything behind for
/// [`left_behind`](super::left_behind), as a crash does.
#[derive(Debug)]
pub struct Keeper {
    folder: PathBuf,
    lock: Lock,
    /// Fingerprint of the snapshot; `None` after one that failed.
    snapshot: Option<String>,
    /// Number of results that are kept.
    results: usize,
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
        let mut keeper = Self::start(folder).map_err(|error| WriteError::io(folder, error))?;
        write_origin(&keeper.folder, origin)?;
        journal::write(&keeper.folder.join(JOURNAL), &[])?;
        keeper.write_snapshot(session)?;
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
            snapshot: None,
            results: 0,
        })
    }

    fn write_snapshot(&mut self, session: &Session) -> Result<(), WriteError> {
        let path = self.folder.join(SNAPSHOT);
        self.snapshot = None;
        write_session(&path, session)?;
        let found = Fingerprint::of_file(&path).map_err(|error| WriteError::io(&path, error))?;
        self.snapshot = Some(found.to_hex());
        self.results = session.results().len();
        Ok(())
    }

    /// Keeps the whole session as it is now. Poses in the journal that it does not have stay there.
    ///
    /// # Errors
    /// If the files cannot be written; what was kept before is still kept then.
    pub fn snapshot(&mut self, session: &Session) -> Result<(), WriteError> {
        self.write_snapshot(session)?;
        // Those of an older snapshot; ignored where this fails.
        let _ = fs::remove_file(self.folder.join(CHANGES));
        let _ = fs::remove_file(self.folder.join(RESULTS));
        let path = self.folder.join(JOURNAL);
        let bytes = fs::read(&path).map_err(|error| WriteError::io(&path, error))?;
        let has = |label: &i64| session.measurements.labels.contains(label);
        let mut entries = Journal::parse(&bytes).entries;
        entries.retain(|entry| !entry.table.labels().iter().all(has));
        journal::write(&path, &entries)
    }

    /// Keeps the session as it is now, whose measured poses are those of the last snapshot and of the
    /// journal.
    ///
    /// # Errors
    /// If the last snapshot could not be written, or this cannot; what was kept before is still kept then.
    pub fn changed(&mut self, mut changes: Changes) -> Result<(), WriteError> {
        let path = self.folder.join(CHANGES);
        let Some(snapshot) = self.snapshot.clone() else {
            let message = "the session before this change could not be kept".into();
            return Err(WriteError::Content { path, message });
        };
        let added = changes.take_results();
        results::keep(&self.folder.join(RESULTS), &added, self.results)?;
        self.results = added.len().max(self.results);
        write_document(&path, &changes.since(snapshot))
    }

    /// Keeps one more measured pose; it is on disk when this returns.
    ///
    /// # Errors
    /// If the readings hold an infinite number or the journal cannot be written.
    pub fn measured(&mut self, pose: &MeasuredPose) -> Result<(), WriteError> {
        let path = self.folder.join(JOURNAL);
        let finite = Columns::of(&pose.readings).check_finite();
        finite.map_err(|fault| WriteError::Content {
            path: path.clone(),
            message: FieldError::from(fault).to_string(),
        })?;
        let line = Entry::of(pose).line();
        let line = line.map_err(|error| WriteError::io(&path, error))?;
        journal::append(&path, &line)
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
