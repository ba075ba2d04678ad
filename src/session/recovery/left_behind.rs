//! What programs that ended without saving have left behind.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use super::changes::ChangesDocument;
use super::journal::{Entry, Journal};
use super::keeper::Lock;
use super::{
    CHANGES, DISCARDED, FINISHED, JOURNAL, LOCK, ORIGIN, Origin, PREFIX, RESULTS, SNAPSHOT, results,
};
use crate::atomic::sync_folder;
use crate::error::{Loaded, Place, ReadError, WriteError};
use crate::fingerprint::Fingerprint;
use crate::json::read_document;
use crate::session::{MeasurementTable, Session, Timestamp, read_session};

/// An unsaved session of a program that no longer runs; no other program is offered it while this
/// value lives.
#[derive(Debug)]
pub struct LeftBehind {
    /// Name of the session, or of its folder if the session cannot be read.
    pub name: String,
    /// The file that it belongs to, if it was ever saved.
    pub origin: Option<PathBuf>,
    /// When something was last kept.
    pub when: Timestamp,
    /// Number of measured poses in it, the home pose included.
    pub poses: usize,
    /// Why it cannot be recovered.
    pub problem: Option<ReadError>,
    folder: PathBuf,
    lock: Lock,
}

/// A session as it was when the program ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// The session.
    pub session: Session,
    /// The file that it belongs to, if it was ever saved; what is in that file is older.
    pub origin: Option<PathBuf>,
}

/// Finds in a recovery folder what was left behind, the latest first. Sessions that cannot be read
/// are in the list, too.
///
/// # Errors
/// If the folder or a lock in it cannot be read; a folder that does not exist is empty.
pub fn left_behind(folder: &Path) -> Result<Vec<LeftBehind>, ReadError> {
    let file = folder.display().to_string();
    let mut found = Vec::new();
    for own in candidates(folder).map_err(|error| ReadError::io(&file, Place::File, &error))? {
        let Some(lock) = locked(own.with_extension(LOCK))? else {
            continue;
        };
        if own.extension().is_some() || holds_nothing(&own) {
            // Nothing is lost if this fails: the next search tries again.
            let _ = fs::remove_dir_all(&own);
            let _ = lock.remove();
        } else {
            found.push(LeftBehind::examine(own, lock));
        }
    }
    found.sort_by(|a, b| b.when.cmp(&a.when).then_with(|| a.folder.cmp(&b.folder)));
    Ok(found)
}

/// Folders of sessions, and of finished ones that were not removed to the end.
fn candidates(folder: &Path) -> IoResult<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let paths: IoResult<Vec<PathBuf>> = entries.map(|entry| Ok(entry?.path())).collect();
    let is_candidate = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let extension = path.extension();
        name.starts_with(PREFIX) && extension.is_none_or(|e| e == FINISHED) && path.is_dir()
    };
    Ok(paths?.into_iter().filter(is_candidate).collect())
}

/// The lock, or none if a running program has it.
fn locked(path: PathBuf) -> Result<Option<Lock>, ReadError> {
    let open = || {
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        options.open(&path)
    };
    let fail = |error| ReadError::io(&path.display().to_string(), Place::File, &error);
    let file = open().map_err(fail)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(Lock { file, path })),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) => Err(fail(error)),
    }
}

/// Whether the program ended before it kept anything, the snapshot coming last, or finished between
/// listing and locking.
fn holds_nothing(own: &Path) -> bool {
    let size = |name: &str| match fs::metadata(own.join(name)) {
        Err(error) if error.kind() == ErrorKind::NotFound => Some(0),
        metadata => metadata.ok().map(|metadata| metadata.len()),
    };
    size(SNAPSHOT) == Some(0) && size(JOURNAL) == Some(0)
}

impl LeftBehind {
    fn examine(folder: PathBuf, lock: Lock) -> Self {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let mut left = Self {
            name: name.into_owned(),
            origin: None,
            when: last_change(&folder),
            poses: 0,
            problem: None,
            folder,
            lock,
        };
        match left.recover() {
            Ok(recovered) => {
                let Recovered { session, origin } = recovered.value;
                left.poses = session.measurements.len();
                left.name = session.name;
                left.origin = origin;
            }
            Err(error) => left.problem = Some(error),
        }
        left
    }

    /// The folder with its files.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The session as it was, the poses of the journal included. The files stay: keep the session
    /// with a new [`Keeper`](super::Keeper) first, then [`discard`](Self::discard) these.
    ///
    /// # Errors
    /// If the snapshot cannot be read.
    pub fn recover(&self) -> Result<Loaded<Recovered>, ReadError> {
        let Loaded { value, mut notices } = read_session(&self.folder.join(SNAPSHOT))?;
        let mut session = value;
        let journal = self.journal(&mut notices);
        if let Some(changes) = self.changes(&mut notices) {
            session = changed(session, changes, &journal, &mut notices);
        }
        notices.extend(results::add(&self.folder.join(RESULTS), &mut session));
        let file = self.folder.join(JOURNAL).display().to_string();
        notices.extend(replay(&mut session, journal, &file));
        let origin = match read_document::<Origin>(&self.folder.join(ORIGIN)) {
            Ok(loaded) => loaded.value.path.map(PathBuf::from),
            Err(error) => {
                notices.push(format!("{error}; the session has to be saved under a name"));
                None
            }
        };
        Ok(Loaded {
            value: Recovered { session, origin },
            notices,
        })
    }

    fn journal(&self, notices: &mut Vec<String>) -> Journal {
        let path = self.folder.join(JOURNAL);
        match fs::read(&path) {
            Ok(bytes) => Journal::parse(&bytes),
            Err(error) => {
                let error = ReadError::io(&path.display().to_string(), Place::File, &error);
                notices.push(format!("{error}; poses measured last may be missing"));
                Journal::default()
            }
        }
    }

    /// The changes that follow the snapshot, if there are any.
    fn changes(&self, notices: &mut Vec<String>) -> Option<ChangesDocument> {
        let path = self.folder.join(CHANGES);
        if !path.exists() {
            return None;
        }
        match read_document::<ChangesDocument>(&path) {
            Ok(loaded) => {
                let snapshot = Fingerprint::of_file(&self.folder.join(SNAPSHOT)).ok()?;
                let changes = Some(loaded.value);
                changes.filter(|changes| changes.snapshot == snapshot.to_hex())
            }
            Err(error) => {
                notices.push(format!("{error}; what was edited last is missing"));
                None
            }
        }
    }

    /// Moves the files aside, into the folder `discarded` of the recovery folder, which it returns:
    /// measurements are never deleted.
    ///
    /// # Errors
    /// If the files cannot be moved.
    pub fn discard(self) -> Result<PathBuf, WriteError> {
        let parent = self.folder.parent().unwrap_or(Path::new("."));
        let aside = parent.join(DISCARDED);
        let target = aside.join(self.folder.file_name().unwrap_or_default());
        fs::create_dir_all(&aside)
            .and_then(|()| fs::rename(&self.folder, &target))
            .and_then(|()| sync_folder(&aside))
            .and_then(|()| sync_folder(parent))
            .and_then(|()| self.lock.remove())
            .map_err(|error| WriteError::io(&self.folder, error))?;
        Ok(target)
    }
}

/// The snapshot with what was changed after it; poses of the journal that the session did not have then
/// are still to come.
fn changed(
    snapshot: Session,
    changes: ChangesDocument,
    journal: &Journal,
    notices: &mut Vec<String>,
) -> Session {
    let ChangesDocument {
        mut session,
        measured,
        ..
    } = changes;
    *session.results_mut() = snapshot.results().to_vec();
    let mut session = match session.with_measurements_of(&snapshot.measurements) {
        Ok(session) => session,
        Err(error) => {
            notices.push(format!(
                "What was edited last does not fit the measured poses and is missing: {error}"
            ));
            return snapshot;
        }
    };
    let excluded = session.excluded().clone();
    let measured: BTreeSet<i64> = measured.into_iter().collect();
    for entry in &journal.entries {
        if entry.table.labels().iter().all(|l| measured.contains(l)) {
            // What does not fit is told when the journal is replayed.
            let _ = session.append_table(entry.table.clone(), None);
        }
    }
    for label in &excluded {
        session.include(*label);
    }
    for label in excluded {
        // A pose whose line is damaged cannot be left out, and need not.
        let _ = session.exclude(label);
    }
    session
}

/// Adds the poses of the journal that the session does not have yet.
fn replay(session: &mut Session, journal: Journal, file: &str) -> Vec<String> {
    let mut notices = Vec::new();
    for line in journal.damaged {
        notices.push(format!(
            "{file}, line {line}: damaged, a pose measured here is missing"
        ));
    }
    for entry in journal.entries {
        let label = entry.table.labels().first().copied().unwrap_or_default();
        match known_row(session, &entry) {
            Some(true) => {}
            Some(false) => notices.push(format!(
                "{file}: pose {label} was measured twice with different readings, the first are kept"
            )),
            None => {
                if let Err(error) = session.append_table(entry.table, entry.repeats) {
                    notices.push(format!("{file}: pose {label} does not fit: {error}"));
                }
            }
        }
    }
    if journal.is_torn {
        notices.push(format!(
            "{file}: the program ended while a pose was being written, that pose is missing"
        ));
    }
    notices
}

/// Whether the session has the pose with the same readings, if it has it at all.
fn known_row(session: &Session, entry: &Entry) -> Option<bool> {
    let label = entry.table.labels().first()?;
    let m = &session.measurements;
    let row = m.labels.iter().position(|known| known == label)?;
    let known = MeasurementTable::of(&m.select(&[row]));
    Some(entry.table.is_contained_in(&known))
}

/// When anything of the session was last written.
fn last_change(folder: &Path) -> Timestamp {
    let seconds = [SNAPSHOT, JOURNAL, CHANGES, RESULTS]
        .iter()
        .filter_map(|name| {
            let changed = fs::metadata(folder.join(name)).ok()?.modified().ok()?;
            i64::try_from(changed.duration_since(UNIX_EPOCH).ok()?.as_secs()).ok()
        });
    Timestamp::from_unix_seconds(seconds.max().unwrap_or_default())
}
