//! Writing of files in tasks.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use crate::model::command::Outcome;
use crate::model::dialogs::{SaveContent, SaveDraft};
use crate::model::messages::{Cause, Severity};
use crate::model::save_form::SaveForm;
use crate::model::{Model, OpenSession};

/// Initial folder of file dialogs: that of the open session, or of the last one.
pub fn usual_folder(model: &Model) -> PathBuf {
    let own = model.open.as_ref().and_then(OpenSession::path);
    let recent = model
        .preferences
        .recent()
        .first()
        .map(|recent| recent.path());
    let folder = own.or(recent).and_then(Path::parent);
    let present = || std::env::current_dir().unwrap_or_default();
    folder.map_or_else(present, Path::to_owned)
}

/// Asks for a path to save to; suggests this name.
pub fn ask_save(model: &mut Model, content: SaveContent, name: impl AsRef<Path>) {
    let form = SaveForm::new(&usual_folder(model).join(name));
    model.dialogs.save = Some(SaveDraft { form, content });
}

/// Name of a file, or its path if it has none.
pub fn file_label(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// Writes a file in a task of this title.
pub fn write<E: Display>(
    model: &mut Model,
    title: &str,
    path: PathBuf,
    work: impl FnOnce(&Path) -> Result<(), E> + Send + 'static,
) {
    write_with_warning(model, title, path, move |path| {
        work(path).map(|()| None).map_err(|error| error.to_string())
    });
}

/// Writes a file in a task of this title; `work` may return a warning.
pub fn write_with_warning(
    model: &mut Model,
    title: &str,
    path: PathBuf,
    work: impl FnOnce(&Path) -> Result<Option<String>, String> + Send + 'static,
) {
    model.messages.resolve(Cause::Saving);
    model.tasks.start(title, move |_| {
        let result = work(&path);
        Outcome::Written(path, result)
    });
}

/// Handles the result of writing a file: the dialog that waits for it closes or shows the error.
pub fn written(model: &mut Model, path: &Path, result: Result<(), String>) {
    match result {
        Ok(()) => {
            model.dialogs.close(path);
            model.messages.info(format!("Saved {}.", path.display()));
        }
        Err(text) => match model.dialogs.failure(path) {
            Some(failure) => {
                *failure = Some(text.clone());
                model.messages.log(Severity::Error, text);
            }
            None => model.messages.failure(Cause::Saving, text),
        },
    }
}
