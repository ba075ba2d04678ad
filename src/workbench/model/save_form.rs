//! Form that asks for a path to save to.

use std::path::{Path, PathBuf};

use tautline_session::link_target;

/// Path of a file to write, and the error if writing failed.
#[derive(Debug, Clone, Default)]
pub struct SaveForm {
    /// Path as typed.
    pub path: String,
    /// File being written.
    pub(crate) writing: Option<PathBuf>,
    /// Error of the last attempt.
    pub(crate) failure: Option<String>,
}

impl SaveForm {
    /// Form with a suggested path.
    pub(crate) fn new(path: &Path) -> Self {
        Self {
            path: absolute(path).display().to_string(),
            ..Self::default()
        }
    }

    /// Target path with links resolved; `None` while nothing is typed.
    pub(crate) fn target(&self) -> Option<PathBuf> {
        let typed = self.path.trim();
        (!typed.is_empty()).then(|| link_target(&absolute(Path::new(typed))))
    }

    pub(crate) fn can_save(&self) -> bool {
        self.writing.is_none() && self.target().is_some()
    }

    /// Waits for this file to be written.
    pub(crate) fn begin(&mut self, path: PathBuf) {
        self.writing = Some(path);
        self.failure = None;
    }

    pub(crate) fn waits_for(&self, path: &Path) -> bool {
        self.writing.as_deref() == Some(path)
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
