//! The file of a session while a program works on it.
//!
//! The folder `SESSION.unsaved` exists beside the file as long as a command runs or the window has unsaved
//! changes: its lock keeps other programs away, and the poses that a command measures are written there before
//! they are in the file. If the program is killed the folder stays, and the next program that opens the session
//! recovers the poses.

mod lock;
mod space;
mod window;

use std::ffi::OsString;
use std::fs;
use std::io::{Error as IoError, ErrorKind};
use std::path::{Path, PathBuf};

use tautline_core::robot::FieldError;
use tautline_files::ReadError;
use tautline_session::{
    LogEntry, Phase, RecoveryWriter, Session, UnsavedSession, WriteError, find_unsaved_sessions,
    link_target, read_session, remove_discarded, write_session,
};

use crate::adjusting::open as open_adjustment;
use crate::audit;
use crate::clock;
use crate::controllers::{beside, is_held_values};
use crate::wording::{count, sentence};
pub use lock::{FileLock, LockError, unsaved_folder};
pub use space::ReservedSpace;
pub use window::OpenWindow;

/// Suffix of the file that contains a simulated controller's values while they are being written.
const CONTROLLER: &str = ".controller";
/// Prefix of the folder of an autosave that could not be recovered completely.
const DAMAGED: &str = "damaged-";

/// Errors of working on a session file.
#[derive(Debug, thiserror::Error)]
pub enum SessionFileError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file cannot be locked.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The unsaved data of a killed program cannot be read.
    #[error(
        "{}: the unsaved measurements cannot be read; move the folder away to continue without them: {reason}",
        folder.display()
    )]
    Recovery {
        /// The folder.
        folder: PathBuf,
        /// Reason.
        reason: ReadError,
    },
    /// The unsaved data of a killed program belong to another robot.
    #[error("{}: its poses do not fit the session: {reason}", folder.display())]
    Misfit {
        /// The folder.
        folder: PathBuf,
        /// Difference between the poses and the session.
        reason: FieldError,
    },
    /// There is no disk space for the record.
    #[error("there is no space for the record beside {}: {reason}", path.display())]
    NoSpace {
        /// The session file.
        path: PathBuf,
        /// Reason given by the system.
        reason: IoError,
    },
    /// A file beside the session cannot be read or removed.
    #[error("{} cannot be {action}: {reason}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// `read`, `moved` or `removed`.
        action: &'static str,
        /// Reason given by the system.
        reason: IoError,
    },
}

impl SessionFileError {
    /// Whether the user must correct the input.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Read(_) | Self::Recovery { .. } | Self::Misfit { .. } => true,
            Self::Lock(error) => matches!(error, LockError::NoFolder(_)),
            Self::Write(_) | Self::NoSpace { .. } | Self::Io { .. } => false,
        }
    }
}

/// A session and its file.
pub struct SessionFile {
    /// The file.
    pub path: PathBuf,
    /// The session, including unsaved changes.
    pub session: Session,
    lock: FileLock,
}

/// Recovers the unsaved data of a killed command beside a session file; returns notices about them, also if a command is still
/// working on the session.
pub fn recover_unsaved(path: &Path) -> Vec<String> {
    let mut notices = Vec::new();
    if unsaved_folder(path).exists() {
        let opened = SessionFile::open(path, &mut |text| notices.push(sentence(&text)));
        if let Err(error) = opened {
            notices.push(format!("{error}."));
        }
    }
    notices
}

impl SessionFile {
    /// Reads a session for a command that changes it, including unsaved data of an earlier command. Notices go to `notify`.
    ///
    /// # Errors
    /// If the file is missing, or cannot be read, locked or updated.
    pub fn open(path: &Path, notify: &mut dyn FnMut(String)) -> Result<Self, SessionFileError> {
        Self::open_or_begin(path, || Ok(None), notify)
    }

    /// As [`Self::open`]; if there is no such file, `begin` may create the session.
    ///
    /// # Errors
    /// Those of `begin`; or if the file cannot be read, locked or updated.
    pub fn open_or_begin<E: From<SessionFileError>>(
        path: &Path,
        begin: impl Fn() -> Result<Option<Session>, E>,
        notify: &mut dyn FnMut(String),
    ) -> Result<Self, E> {
        // A session that is opened through a link is one file with one lock.
        let path = &link_target(path);
        let folder = unsaved_folder(path);
        // Errors in a file are reported before anything is written beside it.
        let made = match path.exists() || folder.exists() {
            true => None,
            false => Some(match begin()? {
                Some(session) => session,
                None => read(path, notify)?,
            }),
        };
        let lock = FileLock::acquire(path).map_err(SessionFileError::from)?;
        let left = find_unsaved_sessions(&folder).map_err(SessionFileError::from)?;
        let session = match (path.exists(), made) {
            (true, _) => read(path, notify)?,
            (false, Some(session)) => session,
            (false, None) => match left.first() {
                Some(left) => {
                    left.recover()
                        .map_err(SessionFileError::from)?
                        .value
                        .session
                }
                // The program was killed before it wrote anything.
                None => match begin()? {
                    Some(session) => session,
                    None => read(path, notify)?,
                },
            },
        };
        let mut file = Self {
            path: path.clone(),
            session,
            lock,
        };
        if let Some(text) = audit::notice(&file.session) {
            notify(format!("{}: {text}", file.path.display()));
        }
        file.take_over(left, notify)?;
        // The recovered data are in the file now.
        let folder = file.lock.folder();
        remove_discarded(folder).map_err(SessionFileError::from)?;
        space::free_left(folder).map_err(io("freed", folder))?;
        if open_adjustment(&file.session).is_none() {
            // The values are in the session, which may have changed since.
            file.remove_controller()?;
        }
        Ok(file)
    }

    /// The file with the values of a simulated controller whose write was interrupted.
    pub fn controller(&self) -> PathBuf {
        beside(&self.path, CONTROLLER)
    }

    /// Removes the file with the values of the simulated controller, which are in the session now.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove_controller(&self) -> Result<(), SessionFileError> {
        let path = self.controller();
        // Another file with this name, or a link, must not be removed.
        if !is_held_values(&path) {
            return Ok(());
        }
        match fs::remove_file(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            removed => removed.map_err(io("removed", &path)),
        }
    }

    /// Starts an autosave of measured poses beside the file.
    ///
    /// # Errors
    /// If nothing can be written there.
    pub fn autosave(&self) -> Result<RecoveryWriter, SessionFileError> {
        Ok(RecoveryWriter::create(
            self.lock.folder(),
            Some(&self.path),
            &self.session,
        )?)
    }

    /// Seals the audit trail and writes the file atomically.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&mut self) -> Result<(), SessionFileError> {
        audit::seal(&mut self.session, "");
        Ok(write_session(&self.path, &self.session)?)
    }

    /// Reserves as much disk space as writing the session takes, until the result is dropped.
    ///
    /// # Errors
    /// If there is not enough space.
    pub fn keep_space(&self) -> Result<ReservedSpace, SessionFileError> {
        ReservedSpace::beside(&self.path, self.lock.folder())
    }

    /// Adds an entry to the session's log.
    pub fn log(&mut self, phase: Phase, text: impl Into<String>) {
        self.session.record(LogEntry {
            time: clock::now(),
            phase,
            text: text.into(),
        });
    }

    /// Recovers poses measured by a program that was killed, and writes them to the file.
    fn take_over(
        &mut self,
        left: Vec<UnsavedSession>,
        notify: &mut dyn FnMut(String),
    ) -> Result<(), SessionFileError> {
        for left in left {
            let folder = left.folder().to_owned();
            let recovered = left
                .recover()
                .map_err(|reason| SessionFileError::Recovery {
                    folder: folder.clone(),
                    reason,
                })?;
            recovered.notices.into_iter().for_each(&mut *notify);
            self.take_log(&recovered.value.session);
            let added = self.session.append_missing(&recovered.value.session);
            let added = added.map_err(|reason| SessionFileError::Misfit { folder, reason })?;
            if !added.is_empty() {
                let text = format!(
                    "Recovered {} that a program had measured before it was killed.",
                    count(added.len(), "pose")
                );
                notify(text.clone());
                self.log(Phase::Poses, text);
            }
            self.save()?;
            let aside = left.discard()?;
            if !recovered.value.is_whole {
                self.keep(&aside, notify)?;
            }
        }
        Ok(())
    }
}

impl SessionFile {
    /// Adds log entries of a later state of the session, such as the reasons for the choice of poses.
    fn take_log(&mut self, later: &Session) {
        let known = self.session.log().len();
        if later.log().get(..known) == Some(self.session.log()) {
            for entry in &later.log()[known..] {
                self.session.record(entry.clone());
            }
        }
    }

    /// Moves an autosave that could not be recovered completely to a name that nothing removes.
    fn keep(&self, aside: &Path, notify: &mut dyn FnMut(String)) -> Result<(), SessionFileError> {
        let mut name = OsString::from(DAMAGED);
        name.push(aside.file_name().unwrap_or_default());
        let kept = self.lock.folder().join(name);
        fs::rename(aside, &kept).map_err(io("moved", aside))?;
        notify(format!(
            "{}: the damaged files are kept here",
            kept.display()
        ));
        Ok(())
    }
}

fn io(action: &'static str, path: &Path) -> impl FnOnce(IoError) -> SessionFileError {
    let path = path.to_owned();
    move |reason| SessionFileError::Io {
        path,
        action,
        reason,
    }
}

fn read(path: &Path, notify: &mut dyn FnMut(String)) -> Result<Session, SessionFileError> {
    let read = read_session(path)?;
    read.notices.into_iter().for_each(notify);
    Ok(read.value)
}

#[cfg(all(test, unix))]
mod tests;
