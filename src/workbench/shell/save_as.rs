//! Where to save: a path that is typed or picked.

use std::path::PathBuf;

use egui::{Id, Key, Modal, Role, TextEdit, Ui, WidgetInfo};
use egui_material_icons::icons;

use super::state::State;
use crate::model::command::FileCommand;
use crate::theme::GRID;
use crate::widgets::{Verdict, heading, icon_button, primary, verdict};

/// Draws the window that asks where to save, while it is open.
pub fn show(ui: &mut Ui, state: &mut State) {
    let Some(mut text) = state.model.dialogs.save_as.take() else {
        return;
    };
    let own = state.model.open.as_ref().and_then(|open| open.path());
    let path = PathBuf::from(text.trim());
    let replaces = path.is_file() && own != Some(path.as_path());
    let (mut is_open, mut entered) = (true, false);
    let modal = Modal::new(Id::unique("save as")).show(ui.ctx(), |ui| {
        let width = 560.0_f32.min(ui.ctx().content_rect().width() - 12.0 * GRID);
        ui.set_width(width);
        heading(ui, "Save the session as");
        ui.horizontal(|ui| {
            let field = ui.add(TextEdit::singleline(&mut text).desired_width(width - 120.0));
            field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Path of the session"));
            entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            if ui.memory(|memory| memory.focused().is_none()) {
                field.request_focus();
            }
            if icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked() {
                state.outbox.send(FileCommand::PickSaveAs);
            }
        });
        if replaces {
            verdict(
                ui,
                Verdict::Doubtful,
                "A file with this name exists; it will be replaced.",
            );
        }
        ui.add_space(2.0 * GRID);
        ui.horizontal(|ui| {
            let can_save = !path.as_os_str().is_empty();
            let save = if replaces { "Replace" } else { "Save" };
            if primary(ui, save, can_save).clicked() || entered && can_save {
                state.outbox.send(FileCommand::SaveAs(path.clone()));
                is_open = false;
            }
            if ui.button("Cancel").clicked() {
                is_open = false;
                state.model.dialogs.leaving = None;
            }
        });
    });
    if modal.should_close() {
        is_open = false;
        state.model.dialogs.leaving = None;
    }
    if is_open {
        state.model.dialogs.save_as = Some(text);
    }
}
