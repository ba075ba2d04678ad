//! Unsaved sessions of programs that crashed or were killed.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use tautline_files::{Location, ReadError};

use super::changes::ChangesFile;
use super::journal::{Journal, JournalEntry};
use super::own_files::{Name, check_lock, is_folder, named, remove_session};
use super::writer::Lock;
use super::{CHANGES, DISCARDED, JOURNAL, LOCK, ORIGIN, Origin, RESULTS, SNAPSHOT, results};
use crate::atomic::sync_folder;
use crate::error::{Loaded, WriteError};
use crate::fingerprint::Fingerprint;
use crate::json::read_versioned;
use crate::session::{MeasurementTable, Session, Timestamp, read_session};

/// An unsaved session of a program that no longer runs; as long as this value exists it is locked, so that no other program
/// finds it.
#[derive(Debug)]
pub struct UnsavedSession {
    /// Name of the session, or of its folder if the session cannot be read.
    pub name: String,
    /// The file it was opened from or saved to, if any.
    pub origin: Option<PathBuf>,
    /// Time when its recovery files were last written.
    pub when: Timestamp,
    /// Number of measured poses, the home pose included.
    pub poses: usize,
    /// Reason why it cannot be recovered.
    pub problem: Option<ReadError>,
    folder: PathBuf,
    lock: Lock,
}

/// A recovered session.
#[derive(Debug, Clone, PartialEq)]
pub struct RecoveredSession {
    /// The session.
    pub session: Session,
    /// The file it was opened from or saved to, if any, whose content is older.
    pub origin: Option<PathBuf>,
    /// Whether everything was recovered. Otherwise the snapshot was damaged: the session consists of its file and the poses
    /// measured since, without later edits.
    pub is_whole: bool,
}

/// Finds the unsaved sessions in a recovery folder, the latest first, including sessions that cannot be read.
///
/// # Errors
/// If the folder or a lock in it cannot be read; a folder that does not exist is empty.
pub fn find_unsaved_sessions(folder: &Path) -> Result<Vec<UnsavedSession>, ReadError> {
    let file = folder.display().to_string();
    let mut found = Vec::new();
    for own in candidates(folder).map_err(|error| ReadError::io(&file, Location::File, &error))? {
        let Some(lock) = locked(own.with_extension(LOCK))? else {
            continue;
        };
        if own.extension().is_some() || holds_nothing(&own) {
            // Nothing is lost if this fails: the next search tries again.
            let _ = remove_session(&own);
            let _ = lock.remove();
        } else {
            found.push(UnsavedSession::examine(own, lock));
        }
    }
    found.sort_by(|a, b| b.when.cmp(&a.when).then_with(|| a.folder.cmp(&b.folder)));
    Ok(found)
}

/// Folders of sessions, and of saved ones that were not completely removed.
fn candidates(folder: &Path) -> IoResult<Vec<PathBuf>> {
    let mut found = named(folder, Name::Session)?;
    found.extend(named(folder, Name::Finished)?);
    found.retain(|path| is_folder(path));
    Ok(found)
}

/// The lock, or `None` if a running program holds it.
fn locked(path: PathBuf) -> Result<Option<Lock>, ReadError> {
    let open = || {
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        check_lock(&path).and_then(|()| options.open(&path))
    };
    let fail = |error| ReadError::io(&path.display().to_string(), Location::File, &error);
    let file = open().map_err(fail)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(Lock { file, path })),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) => Err(fail(error)),
    }
}

/// Whether snapshot and journal are missing or empty: the program ended before it wrote them, or removed its files between
/// listing and locking.
fn holds_nothing(own: &Path) -> bool {
    let size = |name: &str| match fs::metadata(own.join(name)) {
        Err(error) if error.kind() == ErrorKind::NotFound => Some(0),
        metadata => metadata.ok().map(|metadata| metadata.len()),
    };
    size(SNAPSHOT) == Some(0) && size(JOURNAL) == Some(0)
}

impl UnsavedSession {
    fn examine(folder: PathBuf, lock: Lock) -> Self {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let mut unsaved = Self {
            name: name.into_owned(),
            origin: None,
            when: last_change(&folder),
            poses: 0,
            problem: None,
            folder,
            lock,
        };
        match unsaved.recover() {
            Ok(recovered) => {
                let RecoveredSession {
                    session, origin, ..
                } = recovered.value;
                unsaved.poses = session.measurements.len();
                unsaved.name = session.name;
                unsaved.origin = origin;
            }
            Err(error) => unsaved.problem = Some(error),
        }
        unsaved
    }

    /// The folder with the recovery files.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Recovers the session with the poses of the journal. The files stay: first write the session with a new
    /// [`RecoveryWriter`](super::RecoveryWriter), then [`discard`](Self::discard) them.
    ///
    /// If the snapshot cannot be read, the poses of the journal are still recovered: the session is then that of
    /// its file, and [`RecoveredSession::is_whole`] is false.
    ///
    /// # Errors
    /// If neither the snapshot nor the file of the session can be read.
    pub fn recover(&self) -> Result<Loaded<RecoveredSession>, ReadError> {
        let mut notices = Vec::new();
        let origin = self.read_origin(&mut notices);
        let snapshot = read_session(&self.folder.join(SNAPSHOT));
        let is_whole = snapshot.is_ok();
        let mut session = match snapshot {
            Ok(loaded) => {
                notices.extend(loaded.notices);
                loaded.value
            }
            Err(error) => session_of_file(origin.as_deref(), error, &mut notices)?,
        };
        let journal = self.journal(&mut notices);
        if let Some(changes) = self.changes(&mut notices) {
            session = changed(session, changes, &journal, &mut notices);
        }
        notices.extend(results::add(&self.folder.join(RESULTS), &mut session));
        let file = self.folder.join(JOURNAL).display().to_string();
        notices.extend(replay(&mut session, journal, &file));
        session.cover_rest();
        Ok(Loaded {
            value: RecoveredSession {
                session,
                origin,
                is_whole,
            },
            notices,
        })
    }

    fn read_origin(&self, notices: &mut Vec<String>) -> Option<PathBuf> {
        match read_versioned::<Origin>(&self.folder.join(ORIGIN)) {
            Ok(loaded) => loaded.value.path.map(PathBuf::from),
            Err(error) => {
                notices.push(format!("{error}; save the session under a new name"));
                None
            }
        }
    }

    fn journal(&self, notices: &mut Vec<String>) -> Journal {
        let path = self.folder.join(JOURNAL);
        match fs::read(&path) {
            Ok(bytes) => Journal::parse(&bytes),
            Err(error) => {
                let error = ReadError::io(&path.display().to_string(), Location::File, &error);
                notices.push(format!("{error}; the latest measured poses may be missing"));
                Journal::default()
            }
        }
    }

    /// The changes that belong to the snapshot, if any.
    fn changes(&self, notices: &mut Vec<String>) -> Option<ChangesFile> {
        let path = self.folder.join(CHANGES);
        if !path.exists() {
            return None;
        }
        match read_versioned::<ChangesFile>(&path) {
            Ok(loaded) => {
                let snapshot = Fingerprint::of_file(&self.folder.join(SNAPSHOT)).ok()?;
                let changes = Some(loaded.value);
                changes.filter(|changes| changes.snapshot == snapshot.to_hex())
            }
            Err(error) => {
                notices.push(format!("{error}; the latest edits are missing"));
                None
            }
        }
    }

    /// Moves the files to the folder `discarded` of the recovery folder and returns their new path: measurements are
    /// never deleted.
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

/// The session from the file that it was opened from, as its snapshot cannot be read because of `damage`.
fn session_of_file(
    origin: Option<&Path>,
    damage: ReadError,
    notices: &mut Vec<String>,
) -> Result<Session, ReadError> {
    let Some(loaded) = origin.and_then(|file| read_session(file).ok()) else {
        return Err(damage);
    };
    notices.push(format!(
        "{damage}; the session is that of its file with the poses measured since then, and edits since then are missing"
    ));
    notices.extend(loaded.notices);
    Ok(loaded.value)
}

/// The snapshot with the changes after it; poses of the journal that the session did not have at that time are added
/// later.
fn changed(
    snapshot: Session,
    changes: ChangesFile,
    journal: &Journal,
    notices: &mut Vec<String>,
) -> Session {
    let ChangesFile {
        mut session,
        measured,
        ..
    } = changes;
    *session.results_mut() = snapshot.results().to_vec();
    let mut session = match session.with_measurements_of(&snapshot.measurements) {
        Ok(session) => session,
        Err(error) => {
            notices.push(format!(
                "the latest edits do not fit the measured poses and are missing: {error}"
            ));
            return snapshot;
        }
    };
    let excluded = session.excluded().clone();
    let measured: BTreeSet<i64> = measured.into_iter().collect();
    for entry in &journal.entries {
        if entry.table.labels().iter().all(|l| measured.contains(l)) {
            // Poses that do not fit are reported when the journal is replayed.
            let _ = session.append_table(entry.table.clone(), None, None);
        }
    }
    for label in &excluded {
        session.include(*label);
    }
    for label in excluded {
        // The pose of a damaged line cannot be excluded, and need not be.
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
                "{file}: pose {label} was measured twice with different readings; the first ones are used"
            )),
            None => {
                if let Err(error) = session.append_table(entry.table, entry.repeats, entry.started) {
                    notices.push(format!("{file}: pose {label} does not fit: {error}"));
                }
            }
        }
    }
    if journal.is_torn {
        notices.push(format!(
            "{file}: the program ended while a pose was being written; that pose is missing"
        ));
    }
    notices
}

/// Whether the session's pose with this label has the same readings; `None` if there is no such pose.
fn known_row(session: &Session, entry: &JournalEntry) -> Option<bool> {
    let label = entry.table.labels().first()?;
    let m = &session.measurements;
    let row = m.labels.iter().position(|known| known == label)?;
    let known = MeasurementTable::of(&m.select(&[row]));
    Some(entry.table.is_contained_in(&known))
}

/// Time of the last write to the recovery files of a session.
fn last_change(folder: &Path) -> Timestamp {
    let seconds = [SNAPSHOT, JOURNAL, CHANGES, RESULTS]
        .iter()
        .filter_map(|name| {
            let changed = fs::metadata(folder.join(name)).ok()?.modified().ok()?;
            i64::try_from(changed.duration_since(UNIX_EPOCH).ok()?.as_secs()).ok()
        });
    Timestamp::from_unix_seconds(seconds.max().unwrap_or_default())
}
