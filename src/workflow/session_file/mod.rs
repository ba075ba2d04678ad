//! The file of a session while a program works on it.
//!
//! Beside the file lies the folder `SESSION.unsaved` as long as a command runs or the window has changes that the file
//! does not have: its lock keeps other programs away, and the poses that a command measures are written there before
//! they are in the file. If the program is killed the folder stays, and the next program that opens the session takes
//! the poses over.

mod lock;
mod space;

use std::fs;
use std::io::{Error as IoError, ErrorKind};
use std::path::{Path, PathBuf};

use tautline_core::robot::FieldError;
use tautline_session::{
    LogEntry, Phase, ReadError, RecoveryWriter, Session, UnsavedSession, WriteError,
    find_unsaved_sessions, read_session, write_session,
};

use crate::adjusting::open as open_adjustment;
use crate::clock;
use crate::controllers::beside;
use crate::wording::{count, sentence};
use lock::LOCK_NAME;
pub use lock::{FileLock, LockError, unsaved_folder};
pub use space::KeptSpace;

/// Ending of the file that a simulated controller's values are in while they are written.
const CONTROLLER: &str = ".controller";
/// Folder for discarded autosaves, whose poses are in the file by then.
const DISCARDED: &str = "discarded";

/// Why a session file cannot be worked on.
#[derive(Debug, thiserror::Error)]
pub enum SessionFileError {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It cannot be locked.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// What a killed program had measured cannot be read.
    #[error(
        "{}: what was measured last cannot be read; move the folder away to go on without it: {reason}",
        folder.display()
    )]
    Recovery {
        /// The folder.
        folder: PathBuf,
        /// Why not.
        reason: ReadError,
    },
    /// What a killed program had measured belongs to another robot.
    #[error("{}: its poses do not fit the session: {reason}", folder.display())]
    Misfit {
        /// The folder.
        folder: PathBuf,
        /// What does not fit.
        reason: FieldError,
    },
    /// There is no space for what is to be recorded.
    #[error("there is no space for the record beside {}: {reason}", path.display())]
    NoSpace {
        /// The session.
        path: PathBuf,
        /// Reason given by the system.
        reason: IoError,
    },
    /// A file beside it cannot be read or removed.
    #[error("{} cannot be {action}: {reason}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Read or removed.
        action: &'static str,
        /// Reason given by the system.
        reason: IoError,
    },
}

impl SessionFileError {
    /// Whether the user has to correct the input.
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
    /// The session, changes that are not in the file yet included.
    pub session: Session,
    lock: FileLock,
}

/// Takes over what a killed command has left beside a session file; notices about it, also that a command is still
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
    /// Reads a session for a command that changes it, with what an earlier command has left unsaved. Notices go to
    /// `notify`.
    ///
    /// # Errors
    /// If the file is missing, or cannot be read, locked or brought up to date.
    pub fn open(path: &Path, notify: &mut dyn FnMut(String)) -> Result<Self, SessionFileError> {
        Self::open_or_begin(path, || Ok(None), notify)
    }

    /// The same; where there is no such file `begin` may make the session.
    ///
    /// # Errors
    /// Those of `begin`; or if the file cannot be read, locked or brought up to date.
    pub fn open_or_begin<E: From<SessionFileError>>(
        path: &Path,
        begin: impl Fn() -> Result<Option<Session>, E>,
        notify: &mut dyn FnMut(String),
    ) -> Result<Self, E> {
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
                // The program was killed before it had written anything.
                None => match begin()? {
                    Some(session) => session,
                    None => read(path, notify)?,
                },
            },
        };
        let mut file = Self {
            path: path.to_owned(),
            session,
            lock,
        };
        file.take_over(left, notify)?;
        file.tidy()?;
        if open_adjustment(&file.session).is_none() {
            // The values are in the session, which may have changed since.
            file.remove_controller()?;
        }
        Ok(file)
    }

    /// The file with the values that a simulated controller was left with in the middle of writing.
    pub fn controller(&self) -> PathBuf {
        beside(&self.path, CONTROLLER)
    }

    /// The session has the values of the simulated controller: their own file is removed.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove_controller(&self) -> Result<(), SessionFileError> {
        let path = self.controller();
        match fs::remove_file(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            removed => removed.map_err(io("removed", &path)),
        }
    }

    /// Starts to write measured poses beside the file.
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

    /// Writes the file, completely or not at all.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&self) -> Result<(), SessionFileError> {
        Ok(write_session(&self.path, &self.session)?)
    }

    /// Keeps as much space on the disk as writing the session takes, until the result is dropped.
    ///
    /// # Errors
    /// If there is not enough.
    pub fn keep_space(&self) -> Result<KeptSpace, SessionFileError> {
        KeptSpace::beside(&self.path, self.lock.folder())
    }

    /// Adds to the session's log.
    pub fn log(&mut self, phase: Phase, text: impl Into<String>) {
        self.session.record(LogEntry {
            time: clock::now(),
            phase,
            text: text.into(),
        });
    }

    /// Removes what was taken over, which is in the file now, and the locks of folders that a killed program had made
    /// but not used, or had removed already.
    fn tidy(&self) -> Result<(), SessionFileError> {
        let folder = self.lock.folder();
        for entry in fs::read_dir(folder).map_err(io("read", folder))? {
            let path = entry.map_err(io("read", folder))?.path();
            let removed = match path.file_name() {
                Some(name) if name == DISCARDED => fs::remove_dir_all(&path),
                Some(name) if name != LOCK_NAME && path.is_file() => fs::remove_file(&path),
                _ => Ok(()),
            };
            removed.map_err(io("removed", &path))?;
        }
        Ok(())
    }

    /// Takes over poses that were measured by a program that was killed, and writes them to the file.
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
            let added = self.session.append_missing(&recovered.value.session);
            let added = added.map_err(|reason| SessionFileError::Misfit { folder, reason })?;
            if !added.is_empty() {
                let text = format!(
                    "{} that a program had measured before it was killed: taken over.",
                    count(added.len(), "pose")
                );
                notify(text.clone());
                self.log(Phase::Poses, text);
            }
            self.save()?;
            left.discard()?;
        }
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
