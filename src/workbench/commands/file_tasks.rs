//! File dialogs and writing files, as tasks.

use std::path::{Path, PathBuf};

use crate::model::Model;
use crate::model::command::{Command, Outcome};

/// Opens a file dialog on a thread of its own; with the file that was picked, `command` is done.
pub fn pick<C: Into<Command>>(
    model: &mut Model,
    dialog: impl FnOnce() -> Option<PathBuf> + Send + 'static,
    command: impl FnOnce(PathBuf) -> C + Send + 'static,
) {
    model.tasks.start("File dialog", move |_| {
        Outcome::Picked(dialog().map(|path| Box::new(command(path).into())))
    });
}

/// Writes a file in a task of this title; `work` may give a warning.
pub fn write(
    model: &mut Model,
    title: &str,
    path: PathBuf,
    work: impl FnOnce(&Path) -> Result<Option<String>, String> + Send + 'static,
) {
    model.tasks.start(title, move |_| {
        Outcome::Written(work(&path).map(|warning| (path, warning)))
    });
}
