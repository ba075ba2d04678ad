//! The file of a session while a command works on it.
//!
//! Beside the file lies the folder `SESSION.unsaved` as long as a command runs: its lock keeps other commands away, and
//! measured poses are there before they are in the file. If the program is killed it stays, and the next
//! command takes the poses over.

use std::fs::{self, File, Metadata, TryLockError};
use std::io::{ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use tautline_session::{
    Keeper, LeftBehind, LogEntry, Outcome, Phase, Session, left_behind, read_session, write_session,
};

use crate::app::clock;
use crate::cli::BadInput;
use crate::controllers::beside;
use crate::wording::count;

/// Ending of the folder.
const UNSAVED: &str = ".unsaved";
/// Ending of the file that a simulated controller's values are in while they are written.
const CONTROLLER: &str = ".controller";
const LOCK: &str = "lock";
/// Where poses go that are in the file by then.
const DISCARDED: &str = "discarded";

/// A session and its file.
pub struct SessionFile {
    /// The file.
    pub path: PathBuf,
    /// What is in it, and what is not yet.
    pub session: Session,
    folder: PathBuf,
    lock: File,
}

impl SessionFile {
    /// Reads a session for a command that changes it, with what an earlier command has left unsaved. Where there is no
    /// such file `begin` makes the session, if it may.
    pub fn open(path: &Path, begin: impl Fn() -> Result<Option<Session>>) -> Result<Self> {
        let folder = beside(path, UNSAVED);
        // What is wrong with a file is said before anything is written beside it.
        let made = match path.exists() || folder.exists() {
            true => None,
            false => Some(begin()?.map_or_else(|| read(path), Ok)?),
        };
        let lock = locked(path, &folder)?;
        let left = left_behind(&folder)?;
        let session = match (path.exists(), made) {
            (true, _) => read(path)?,
            (false, Some(session)) => session,
            (false, None) => match left.first() {
                Some(left) => left.recover()?.value.session,
                // The program was killed before it had written anything.
                None => begin()?.map_or_else(|| read(path), Ok)?,
            },
        };
        let mut file = Self {
            path: path.to_owned(),
            session,
            folder,
            lock,
        };
        file.take_over(left)?;
        file.tidy()?;
        let last = file.session.adjustments().last();
        if last.is_none_or(|last| last.outcome != Outcome::Begun) {
            // The session has its values, and may have got others since.
            file.forget_controller()?;
        }
        Ok(file)
    }

    /// The file with the values that a simulated controller was left with in the middle of writing.
    pub fn controller(&self) -> PathBuf {
        beside(&self.path, CONTROLLER)
    }

    /// The session has the values of the simulated controller: their own file is removed.
    pub fn forget_controller(&self) -> Result<()> {
        let path = self.controller();
        match fs::remove_file(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            removed => removed.with_context(|| format!("{} cannot be removed", path.display())),
        }
    }

    /// Starts to keep measured poses.
    pub fn keep(&self) -> Result<Keeper> {
        Ok(Keeper::begin(
            &self.folder,
            Some(&self.path),
            &self.session,
        )?)
    }

    /// Writes the file, completely or not at all.
    pub fn save(&self) -> Result<()> {
        Ok(write_session(&self.path, &self.session)?)
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
    fn tidy(&self) -> Result<()> {
        let failed = || format!("{} cannot be read", self.folder.display());
        for entry in fs::read_dir(&self.folder).with_context(failed)? {
            let path = entry.with_context(failed)?.path();
            let removed = match path.file_name() {
                Some(name) if name == DISCARDED => fs::remove_dir_all(&path),
                Some(name) if name != LOCK && path.is_file() => fs::remove_file(&path),
                _ => Ok(()),
            };
            removed.with_context(|| format!("{} cannot be removed", path.display()))?;
        }
        Ok(())
    }

    /// Takes over poses that were measured by a program that was killed, and writes them to the file.
    fn take_over(&mut self, left: Vec<LeftBehind>) -> Result<()> {
        for left in left {
            let place = left.folder().display().to_string();
            let recovered = left.recover().with_context(|| {
                format!("{place}: what was measured last cannot be read; move the folder away to go on without it")
            })?;
            for notice in &recovered.notices {
                eprintln!("{notice}");
            }
            let added = self.session.append_missing(&recovered.value.session);
            let added = added.map_err(|error| {
                BadInput::new(format!(
                    "{place}: its poses do not fit the session: {error}"
                ))
            })?;
            if !added.is_empty() {
                let text = format!(
                    "{} that a program had measured before it was killed: taken over.",
                    count(added.len(), "pose")
                );
                eprintln!("{text}");
                self.log(Phase::Poses, text);
            }
            self.save()?;
            left.discard()?;
        }
        Ok(())
    }
}

impl Drop for SessionFile {
    fn drop(&mut self) {
        // While it is locked; what stays behind is an empty folder or poses that are not in the file.
        let _ = fs::remove_file(self.folder.join(LOCK));
        let _ = fs::remove_dir(&self.folder);
        let _ = self.lock.unlock();
    }
}

fn read(path: &Path) -> Result<Session> {
    let read = read_session(path)?;
    for notice in &read.notices {
        eprintln!("{notice}");
    }
    Ok(read.value)
}

/// Locks the session against other commands.
fn locked(path: &Path, folder: &Path) -> Result<File> {
    let lock = folder.join(LOCK);
    let failed = || format!("{} cannot be written", folder.display());
    loop {
        match fs::create_dir(folder) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let message = format!("{}: its folder is not found", path.display());
                return Err(BadInput::new(message));
            }
            made => made.with_context(failed)?,
        }
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let file = match options.open(&lock) {
            // The other program has just removed the folder.
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            opened => opened.with_context(failed)?,
        };
        match file.try_lock() {
            Ok(()) if is_still(&file, &lock).with_context(failed)? => return Ok(file),
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(anyhow!(
                    "{}: another program works on this session at present; wait until it has ended",
                    path.display()
                ));
            }
            Err(TryLockError::Error(error)) => return Err(error).with_context(failed),
        }
    }
}

/// Whether an open file is still the one at `path`, and not one that another program has removed meanwhile.
fn is_still(file: &File, path: &Path) -> IoResult<bool> {
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        there => Ok(is_same(&file.metadata()?, &there?)),
    }
}

#[cfg(unix)]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// Where files in use cannot be removed there is no other.
#[cfg(not(unix))]
fn is_same(_: &Metadata, _: &Metadata) -> bool {
    true
}
