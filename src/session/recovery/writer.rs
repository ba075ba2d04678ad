//! Writes the recovery files of an open session.

use std::fs::{self, File};
use std::io::{Error as IoError, Result as IoResult};
use std::path::{Path, PathBuf};

use tautline_core::robot::FieldError;

use super::changes::SessionChanges;
use super::journal::{self, Journal, JournalEntry};
use super::own_files::remove_session;
use super::{CHANGES, FINISHED, JOURNAL, LOCK, PREFIX, RESULTS, SNAPSHOT, results, write_origin};
use crate::atomic::sync_folder;
use crate::error::WriteError;
use crate::fingerprint::Fingerprint;
use crate::json::write_versioned;
use crate::poses::Columns;
use crate::session::{MeasuredPose, Session, write_session};

/// Writes the unsaved state of an open session to disk.
///
/// If it is dropped without [`RecoveryWriter::finish`], it leaves its files for
/// [`find_unsaved_sessions`](super::find_unsaved_sessions), as a crash does.
#[derive(Debug)]
pub struct RecoveryWriter {
    folder: PathBuf,
    lock: Lock,
    /// Fingerprint of the snapshot; `None` if the last snapshot could not be written.
    snapshot: Option<String>,
    /// Number of results that are on disk.
    results: usize,
}

/// A locked file; the operating system unlocks it however the program ends.
#[derive(Debug)]
pub(super) struct Lock {
    pub file: File,
    pub path: PathBuf,
}

impl RecoveryWriter {
    /// Starts writing to the recovery folder `folder`, for a session that was opened from the file `origin`.
    ///
    /// # Errors
    /// If the files cannot be written.
    pub fn create(
        folder: &Path,
        origin: Option<&Path>,
        session: &Session,
    ) -> Result<Self, WriteError> {
        let mut writer = Self::start(folder).map_err(|error| WriteError::io(folder, error))?;
        write_origin(&writer.folder, origin)?;
        journal::write(&writer.folder.join(JOURNAL), &[])?;
        writer.replace_snapshot(session)?;
        Ok(writer)
    }

    /// The lock is taken first, because a folder without a held lock counts as that of a crashed program.
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

    fn replace_snapshot(&mut self, session: &Session) -> Result<(), WriteError> {
        let path = self.folder.join(SNAPSHOT);
        self.snapshot = None;
        write_session(&path, session)?;
        let found = Fingerprint::of_file(&path).map_err(|error| WriteError::io(&path, error))?;
        self.snapshot = Some(found.to_hex());
        self.results = session.results().len();
        Ok(())
    }

    /// Writes the present state of the whole session. Poses of the journal that it does not contain stay there.
    ///
    /// # Errors
    /// If the files cannot be written; the previous state is then still on disk.
    pub fn write_snapshot(&mut self, session: &Session) -> Result<(), WriteError> {
        self.replace_snapshot(session)?;
        // They belong to the previous snapshot and are ignored if they cannot be removed.
        let _ = fs::remove_file(self.folder.join(CHANGES));
        let _ = fs::remove_file(self.folder.join(RESULTS));
        let path = self.folder.join(JOURNAL);
        let bytes = fs::read(&path).map_err(|error| WriteError::io(&path, error))?;
        let has = |label: &i64| session.measurements.labels.contains(label);
        let mut entries = Journal::parse(&bytes).entries;
        entries.retain(|entry| !entry.table.labels().iter().all(has));
        journal::write(&path, &entries)
    }

    /// Writes the present state of a session whose measured poses are in the last snapshot and the journal.
    ///
    /// # Errors
    /// If the last snapshot could not be written, or the changes cannot; the previous state is then still on disk.
    pub fn write_changes(&mut self, mut changes: SessionChanges) -> Result<(), WriteError> {
        let path = self.folder.join(CHANGES);
        let Some(snapshot) = self.snapshot.clone() else {
            let message = "the snapshot before this change could not be written".into();
            return Err(WriteError::Content { path, message });
        };
        let added = changes.take_results();
        results::append_new(&self.folder.join(RESULTS), &added, self.results)?;
        self.results = added.len().max(self.results);
        write_versioned(&path, &changes.since(snapshot))
    }

    /// Appends a measured pose to the journal; it is on disk when this returns.
    ///
    /// # Errors
    /// If a reading is infinite or the journal cannot be written.
    pub fn append_pose(&mut self, pose: &MeasuredPose) -> Result<(), WriteError> {
        let path = self.folder.join(JOURNAL);
        let finite = Columns::of(&pose.readings).check_finite();
        finite.map_err(|fault| WriteError::Content {
            path: path.clone(),
            message: FieldError::from(fault).to_string(),
        })?;
        let line = JournalEntry::of(pose).line();
        let line = line.map_err(|error| WriteError::io(&path, error))?;
        journal::append(&path, &line)
    }

    /// Removes the files of a saved session.
    ///
    /// # Errors
    /// If they cannot be removed.
    pub fn finish(self) -> Result<(), WriteError> {
        // Renaming first ensures that a kill in between leaves nothing that looks like a crash.
        let finished = self.folder.with_extension(FINISHED);
        fs::rename(&self.folder, &finished)
            .and_then(|()| remove_session(&finished))
            .and_then(|()| self.lock.remove())
            .map_err(|error| WriteError::io(&self.folder, error))
    }
}

impl Lock {
    /// Removes the lock file, whose folder is gone, and unlocks it.
    pub fn remove(self) -> IoResult<()> {
        let removed = fs::remove_file(&self.path);
        drop(self.file);
        removed
    }
}
