//! The file of a session while somebody works on it.
//!
//! Beside the file lies the folder `SESSION.unsaved` as long as a command runs or the window has changes that the file
//! has not: its lock keeps others away, and the poses that a command measures are there before they are in the file. If
//! the program is killed it stays, and whoever opens the session next takes the poses over.

mod held;

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use tautline_session::{
    Keeper, LeftBehind, LogEntry, Outcome, Phase, Session, left_behind, read_session, write_session,
};

use crate::BadInput;
use crate::clock;
use crate::controllers::beside;
use crate::wording::{count, sentence};
use held::LOCK;
pub use held::folder_of;
pub use held::{Held, NotHeld};

/// Ending of the file that a simulated controller's values are in while they are written.
const CONTROLLER: &str = ".controller";
/// Where poses go that are in the file by then.
const DISCARDED: &str = "discarded";

/// A session and its file.
pub struct SessionFile {
    /// The file.
    pub path: PathBuf,
    /// What is in it, and what is not yet.
    pub session: Session,
    held: Held,
}

/// Takes over what a killed command has left beside a session file; what there is to tell about it, also that a command
/// works on the session still.
pub fn settle(path: &Path) -> Vec<String> {
    let mut told = Vec::new();
    if folder_of(path).exists() {
        let opened = SessionFile::open(path, || Ok(None), &mut |text| told.push(sentence(&text)));
        if let Err(error) = opened {
            told.push(format!("{error:#}."));
        }
    }
    told
}

impl SessionFile {
    /// Reads a session for a command that changes it, with what an earlier command has left unsaved. Where there is no
    /// such file `begin` makes the session, if it may. What there is to say is given to `tell`.
    pub fn open(
        path: &Path,
        begin: impl Fn() -> Result<Option<Session>>,
        tell: &mut dyn FnMut(String),
    ) -> Result<Self> {
        let folder = folder_of(path);
        // What is wrong with a file is said before anything is written beside it.
        let made = match path.exists() || folder.exists() {
            true => None,
            false => Some(begin()?.map_or_else(|| read(path, tell), Ok)?),
        };
        let held = Held::take(path).map_err(|error| match error {
            NotHeld::NoFolder(_) => BadInput::new(error),
            error => error.into(),
        })?;
        let left = left_behind(&folder)?;
        let session = match (path.exists(), made) {
            (true, _) => read(path, tell)?,
            (false, Some(session)) => session,
            (false, None) => match left.first() {
                Some(left) => left.recover()?.value.session,
                // The program was killed before it had written anything.
                None => begin()?.map_or_else(|| read(path, tell), Ok)?,
            },
        };
        let mut file = Self {
            path: path.to_owned(),
            session,
            held,
        };
        file.take_over(left, tell)?;
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
            self.held.folder(),
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
        let folder = self.held.folder();
        let failed = || format!("{} cannot be read", folder.display());
        for entry in fs::read_dir(folder).with_context(failed)? {
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
    fn take_over(&mut self, left: Vec<LeftBehind>, tell: &mut dyn FnMut(String)) -> Result<()> {
        for left in left {
            let place = left.folder().display().to_string();
            let recovered = left.recover().with_context(|| {
                format!("{place}: what was measured last cannot be read; move the folder away to go on without it")
            })?;
            recovered.notices.into_iter().for_each(&mut *tell);
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
                tell(text.clone());
                self.log(Phase::Poses, text);
            }
            self.save()?;
            left.discard()?;
        }
        Ok(())
    }
}

fn read(path: &Path, tell: &mut dyn FnMut(String)) -> Result<Session> {
    let read = read_session(path)?;
    read.notices.into_iter().for_each(tell);
    Ok(read.value)
}
