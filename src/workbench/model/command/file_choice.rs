//! Which file or folder the operator is asked for, and what is done with it.

use std::fmt;
use std::path::{Path, PathBuf};

use super::Command;

/// Name of the window of the program that asks for a file.
pub(crate) const WINDOW: &str = "file chooser";

/// What is chosen.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wanted {
    File,
    Folder,
    NewFile,
}

/// Which file or folder is asked for.
#[derive(Debug)]
pub(crate) struct FileRequest {
    pub(crate) title: &'static str,
    pub(crate) wanted: Wanted,
    /// Endings of the files that are shown, if not all.
    pub(crate) endings: &'static [&'static str],
    /// Folder that is shown first.
    pub(crate) folder: PathBuf,
    /// Name that is suggested for a new file.
    pub(crate) name: String,
}

impl FileRequest {
    fn new(title: &'static str, wanted: Wanted) -> Self {
        Self {
            title,
            wanted,
            endings: &[],
            folder: PathBuf::new(),
            name: String::new(),
        }
    }

    /// Asks for a file of one of these endings; of any, if there are none.
    pub(crate) fn file(title: &'static str, endings: &'static [&'static str]) -> Self {
        Self {
            endings,
            ..Self::new(title, Wanted::File)
        }
    }

    pub(crate) fn folder(title: &'static str) -> Self {
        Self::new(title, Wanted::Folder)
    }

    /// Asks where to save; this path is suggested.
    pub(crate) fn new_file(path: &Path) -> Self {
        let name = path.file_name().unwrap_or_default();
        Self {
            folder: path.parent().map_or_else(PathBuf::new, Path::to_owned),
            name: name.to_string_lossy().into_owned(),
            ..Self::new("Save as", Wanted::NewFile)
        }
    }

    fn shows(endings: &[&str], path: &Path) -> bool {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        endings.is_empty() || ending.is_some_and(|own| endings.iter().any(|ending| own == *ending))
    }

    /// The window of the program that asks for it, where the desktop has no dialog.
    fn window(&self) -> egui_file::FileDialog {
        let endings = self.endings;
        let window = match self.wanted {
            Wanted::File => egui_file::FileDialog::open_file(),
            Wanted::Folder => egui_file::FileDialog::select_folder(),
            Wanted::NewFile => egui_file::FileDialog::save_file(),
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

/// A request with the command for the file that is chosen.
pub struct FileChoice {
    pub(crate) request: FileRequest,
    pub(crate) command: Box<dyn FnOnce(PathBuf) -> Command + Send>,
}

impl fmt::Debug for FileChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.request.fmt(f)
    }
}

/// A window that asks for a file.
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
