//! Save dialog with a path to type or choose. It stays open until the file is written.

use std::path::Path;

use egui::{Role, TextEdit, Ui, WidgetInfo};
use egui_material_icons::icons;

use super::state::AppState;
use crate::model::OpenSession;
use crate::model::command::FileCommand;
use crate::model::dialogs::SaveContent;
use crate::model::save_form::SaveForm;
use crate::theme::GRID;
use crate::widgets::{UiExt, entered, icon_button, modal, primary};

/// Draws the save dialog while it is open.
pub fn show(ui: &mut Ui, state: &mut AppState) {
    let Some(mut draft) = state.model.dialogs.save.take() else {
        return;
    };
    let open = state.model.open.as_ref();
    let own = match &draft.content {
        SaveContent::Session => open.and_then(OpenSession::path),
        _ => None,
    };
    let (is_cancelled, is_left) = modal(ui, "save", 560.0, |ui| {
        ui.heading(draft.content.title());
        let asked = form(ui, &mut draft.form, own);
        if asked.browse {
            state.outbox.send(FileCommand::BrowseSave);
        }
        ui.add_space(2.0 * GRID);
        ui.horizontal(|ui| {
            let can_save = draft.form.can_save();
            let verb = if asked.replaces { "Replace" } else { "Save" };
            let is_saved = primary(ui, verb, can_save).clicked() || asked.entered && can_save;
            if let Some(path) = draft.form.target().filter(|_| is_saved) {
                state.outbox.send(draft.content.command(path.clone()));
                draft.form.begin(path);
            }
            ui.button("Cancel").clicked()
        })
        .inner
    });
    if is_cancelled || is_left {
        state.model.dialogs.pending = None;
        state.model.hypothesis.asking = None;
    } else {
        state.model.dialogs.save = Some(draft);
    }
}

/// Input of the operator in a save form.
pub(super) struct SaveResponse {
    pub entered: bool,
    pub browse: bool,
    /// Whether a file other than `own` exists at the path.
    pub replaces: bool,
}

/// Form with a path, and the error if writing failed; the file `own` is overwritten without a question.
pub(super) fn form(ui: &mut Ui, form: &mut SaveForm, own: Option<&Path>) -> SaveResponse {
    let row = ui.horizontal(|ui| {
        let width = ui.available_width() - 120.0;
        let field = ui.add(TextEdit::singleline(&mut form.path).desired_width(width));
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Path of the file"));
        let entered = entered(&field);
        if ui.memory(|memory| memory.focused().is_none()) {
            field.request_focus();
        }
        let browse = icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked();
        (entered, browse)
    });
    let target = form.target();
    let replaces = |path: &&Path| path.is_file() && own != Some(*path);
    let replaces = target.as_deref().filter(replaces).is_some();
    match &form.failure {
        _ if form.writing.is_some() => {
            ui.muted("Saving…");
        }
        Some(why) => ui.bad(why),
        None if replaces => {
            let text = "A file with this name exists; it will be replaced.";
            ui.doubtful(text);
        }
        None => {}
    }
    let (entered, browse) = row.inner;
    SaveResponse {
        entered,
        browse,
        replaces,
    }
}
