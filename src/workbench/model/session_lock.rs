//! Lock of the open session's file.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::OpenSession;
use tautline_workflow::clock;
use tautline_workflow::session_file::{FileLock, LockError, OpenWindow, unsaved_folder};
use tautline_workflow::wording::local_time::time_of_day;

/// Modification time and size of a file, which reveal a later write.
type FileStamp = (Option<SystemTime>, u64);

fn stamp_of(path: &Path) -> Option<FileStamp> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.modified().ok(), metadata.len()))
}

/// File opened or saved by this window.
#[derive(Debug)]
struct KnownFile {
    identity: u64,
    path: PathBuf,
    stamp: Option<FileStamp>,
}

/// Keeps command-line programs from writing the file of the open session while it has unsaved changes, and the window
/// from overwriting their changes.
#[derive(Debug, Default)]
pub struct SessionLock {
    known: Option<KnownFile>,
    held: Option<FileLock>,
    /// Revision at the first attempt to lock the file.
    tried: Option<u64>,
    /// Folder in which windows mark their open files.
    windows: PathBuf,
    /// Mark of this window.
    window: Option<OpenWindow>,
    /// File that is open in another window, with the time since when.
    elsewhere: Option<(PathBuf, String)>,
}

impl SessionLock {
    /// No file is open; windows mark their files in this folder.
    #[must_use]
    pub fn new(windows: PathBuf) -> Self {
        Self {
            windows,
            ..Self::default()
        }
    }

    /// Marks the file as open in this window; `takes_over` takes it from another window.
    ///
    /// # Errors
    /// The time since when it is open in another window.
    pub fn enter(&mut self, path: &Path, takes_over: bool) -> Result<(), String> {
        if self
            .window
            .as_ref()
            .is_none_or(|own| !own.is_of(path) || !own.is_ours())
        {
            let enter = match takes_over {
                true => OpenWindow::take_over,
                false => OpenWindow::enter,
            };
            self.window = enter(&self.windows, path).map_err(time_of_day)?;
        }
        self.elsewhere = None;
        Ok(())
    }

    /// Makes the session read-only, because it is open in another window since this time.
    pub fn look_only(&mut self, path: PathBuf, since: String) {
        (self.window, self.held) = (None, None);
        self.elsewhere = Some((path, since));
    }

    /// Reason why the session is read-only, if so, as a sentence.
    #[must_use]
    pub fn refusal(&self) -> Option<String> {
        let is_lost = self.window.as_ref().is_some_and(|own| !own.is_ours());
        let since = match &self.elsewhere {
            Some((_, since)) => since.clone(),
            None if is_lost => time_of_day(clock::now()),
            None => return None,
        };
        Some(format!(
            "Open in another window since {since}: look only, save as another file, or open it again to take it over."
        ))
    }

    /// Locks the file while there are unsaved changes; returns a sentence if they cannot be saved to it.
    pub fn follow(&mut self, open: Option<&OpenSession>) -> Option<String> {
        let own = open.and_then(|open| Some((open, open.path()?)));
        let Some((open, path)) = own else {
            *self = Self::new(std::mem::take(&mut self.windows));
            return None;
        };
        let identity = open.id();
        let is_known = |known: &KnownFile| known.identity == identity && known.path == path;
        if !self.known.as_ref().is_some_and(is_known) {
            self.written(identity, path);
        }
        if let (None, Some(text)) = (&self.elsewhere, self.refusal()) {
            self.look_only(path.to_owned(), time_of_day(clock::now()));
            return Some(text);
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

    /// Whether this is the file of the open session and it is locked.
    #[must_use]
    pub fn holds(&self, path: &Path) -> bool {
        self.held.is_some() && self.known.as_ref().is_some_and(|known| known.path == path)
    }

    /// Checks that writing the session to a file would not overwrite the changes of another program.
    ///
    /// # Errors
    /// An error message.
    pub fn check(&mut self, path: &Path) -> Result<(), String> {
        let known = self.known.as_ref().filter(|known| known.path == path);
        if let (Some(_), Some(text)) = (known, self.refusal()) {
            return Err(text);
        }
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
                // Saving will report this error.
                Err(_) => {}
            }
        }
        match stamp_of(path) {
            Some(now) if Some(now) != known.stamp => Err(format!(
                "{}: another program has changed this session since it was opened; open it again, or save your changes under another name.",
                path.display()
            )),
            _ => Ok(()),
        }
    }

    /// Records that the file was just read or written.
    pub fn written(&mut self, identity: u64, path: &Path) {
        if !self.holds(path) {
            (self.held, self.tried) = (None, None);
        }
        let is_elsewhere = |(other, _): &(PathBuf, String)| other == path;
        if !self.elsewhere.as_ref().is_some_and(is_elsewhere)
            && let Err(since) = self.enter(path, false)
        {
            self.look_only(path.to_owned(), since);
        }
        self.known = Some(KnownFile {
            identity,
            path: path.to_owned(),
            stamp: stamp_of(path),
        });
    }
}
