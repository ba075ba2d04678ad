//! Requests for a file or folder, with the command that uses it.

use std::fmt;
use std::path::{Path, PathBuf};

use super::Command;

/// Name of the program's own file chooser.
pub(crate) const WINDOW: &str = "file chooser";

/// Kind of path to choose.
#[derive(Debug, Clone, Copy)]
pub(crate) enum PathKind {
    File,
    Folder,
    NewFile,
}

/// Request for a file or folder.
#[derive(Debug)]
pub(crate) struct FileRequest {
    pub(crate) title: &'static str,
    pub(crate) wanted: PathKind,
    /// File extensions that are shown; empty for all.
    pub(crate) endings: &'static [&'static str],
    /// Initial folder.
    pub(crate) folder: PathBuf,
    /// Suggested name of a new file.
    pub(crate) name: String,
}

impl FileRequest {
    fn new(title: &'static str, wanted: PathKind) -> Self {
        Self {
            title,
            wanted,
            endings: &[],
            folder: PathBuf::new(),
            name: String::new(),
        }
    }

    /// Request for a file with one of these extensions; any if empty.
    pub(crate) fn file(title: &'static str, endings: &'static [&'static str]) -> Self {
        Self {
            endings,
            ..Self::new(title, PathKind::File)
        }
    }

    pub(crate) fn folder(title: &'static str) -> Self {
        Self::new(title, PathKind::Folder)
    }

    /// Request for a path to save to, with a suggestion.
    pub(crate) fn new_file(path: &Path) -> Self {
        let name = path.file_name().unwrap_or_default();
        Self {
            folder: path.parent().map_or_else(PathBuf::new, Path::to_owned),
            name: name.to_string_lossy().into_owned(),
            ..Self::new("Save as", PathKind::NewFile)
        }
    }

    fn shows(endings: &[&str], path: &Path) -> bool {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        endings.is_empty() || ending.is_some_and(|own| endings.iter().any(|ending| own == *ending))
    }

    /// The program's own file chooser, for desktops without one.
    fn window(&self) -> egui_file::FileDialog {
        let endings = self.endings;
        let window = match self.wanted {
            PathKind::File => egui_file::FileDialog::open_file(),
            PathKind::Folder => egui_file::FileDialog::select_folder(),
            PathKind::NewFile => egui_file::FileDialog::save_file(),
        };
        let mut window = window
            .id(egui::Id::unique(WINDOW))
            .title(self.title)
            .initial_path(self.folder.as_path())
            .default_filename(self.name.as_str())
            .show_files_filter(Box::new(move |path| Self::shows(endings, path)))
            .open_button_text("Choose".into())
            .save_button_text("Choose".into())
            .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
            .keep_on_top(true)
            .show_rename(false);
        window.open();
        window
    }
}

/// Request with the command for the chosen file.
pub struct FileChoice {
    pub(crate) request: FileRequest,
    pub(crate) command: Box<dyn FnOnce(PathBuf) -> Command + Send>,
}

impl fmt::Debug for FileChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.request.fmt(f)
    }
}

/// The program's own file chooser while it is open.
#[derive(Debug)]
pub(crate) struct FileChooser {
    pub(crate) window: egui_file::FileDialog,
    pub(crate) choice: FileChoice,
}

impl From<FileChoice> for FileChooser {
    fn from(choice: FileChoice) -> Self {
        Self {
            window: choice.request.window(),
            choice,
        }
    }
}
