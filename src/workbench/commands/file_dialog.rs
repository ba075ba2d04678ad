//! Choice of a file: in the dialog of the desktop, or in the program's own file chooser if there is none.

use std::path::PathBuf;

use super::file_tasks::usual_folder;
use crate::model::Model;
use crate::model::command::file_choice::{FileChoice, FileRequest, PathKind};
use crate::model::command::{Command, Outcome};

/// Shows a file dialog on its own thread; `command` receives the chosen path.
pub fn pick<C: Into<Command>>(
    model: &mut Model,
    mut request: FileRequest,
    command: impl FnOnce(PathBuf) -> C + Send + 'static,
) {
    if !request.folder.is_dir() {
        request.folder = usual_folder(model);
    }
    let has_none = model.options.no_desktop_dialogs;
    let choice = FileChoice {
        request,
        command: Box::new(|path| command(path).into()),
    };
    model.tasks.start("File dialog", move |_| {
        if has_none || !desktop_has_dialogs() {
            return Outcome::NoFileDialog(choice);
        }
        let path = desktop_dialog(&choice.request);
        Outcome::Picked(path.map(|path| Box::new((choice.command)(path))))
    });
}

fn desktop_dialog(request: &FileRequest) -> Option<PathBuf> {
    let mut dialog = rfd::FileDialog::new()
        .set_title(request.title)
        .set_directory(&request.folder);
    if !request.endings.is_empty() {
        dialog = dialog
            .add_filter(request.endings.join(", "), request.endings)
            .add_filter("All files", &["*"]);
    }
    match request.wanted {
        PathKind::File => dialog.pick_file(),
        PathKind::Folder => dialog.pick_folder(),
        PathKind::NewFile => dialog.set_file_name(&request.name).save_file(),
    }
}

/// Whether the desktop has file dialogs: rfd does not distinguish a cancelled dialog from a missing one.
#[cfg(all(unix, not(target_os = "macos")))]
fn desktop_has_dialogs() -> bool {
    // Fallback of rfd if there is no portal.
    let zenity = || {
        let found = std::process::Command::new("zenity")
            .arg("--version")
            .output();
        found.is_ok_and(|output| output.status.success())
    };
    zbus::block_on(portal_version()).is_ok() || zenity()
}

#[cfg(not(all(unix, not(target_os = "macos"))))]
fn desktop_has_dialogs() -> bool {
    true
}

/// Version of the portal's file chooser, which exists only if the desktop provides one.
#[cfg(all(unix, not(target_os = "macos")))]
async fn portal_version() -> zbus::Result<()> {
    const PATIENCE: std::time::Duration = std::time::Duration::from_secs(5);
    let builder = zbus::connection::Builder::session()?.method_timeout(PATIENCE);
    let connection = builder.build().await?;
    let asked = connection.call_method(
        Some("org.freedesktop.portal.Desktop"),
        "/org/freedesktop/portal/desktop",
        Some("org.freedesktop.DBus.Properties"),
        "Get",
        &("org.freedesktop.portal.FileChooser", "version"),
    );
    asked.await.map(|_| ())
}
