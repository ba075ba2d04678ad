//! Escape leaves one level at a time: overlays, then the inspector, then the selection.

use egui::{Id, Key, Popup, Ui};

use super::AppState;
use crate::model::Selection;
use crate::model::command::ViewCommand;

/// Leaves the inspector or clears the selection, unless a menu or a text field uses the key. Called before anything is
/// drawn, because these close in the same frame.
pub(super) fn show(ui: &Ui, state: &mut AppState) {
    let typed = ui.data(|data| data.get_temp(typing())).unwrap_or(false);
    let is_used = typed || Popup::is_any_open(ui.ctx());
    let model = &state.model;
    let is_pressed = ui.input(|i| i.modifiers.is_none() && i.key_pressed(Key::Escape));
    if !is_pressed || is_used || model.dialogs.manual.is_some() {
        return;
    }
    if model.inspected.is_some() {
        state.outbox.send(ViewCommand::Inspect(None));
    } else if !model.selection.is_empty() {
        state.outbox.send(ViewCommand::Select(Selection::default()));
    }
}

/// Stores at the end of a frame whether a text field has the focus: in the next frame, Escape has already removed it.
pub(super) fn remember_typing(ui: &Ui) {
    let typed = ui.ctx().text_edit_focused();
    ui.data_mut(|data| data.insert_temp(typing(), typed));
}

fn typing() -> Id {
    Id::unique("typing")
}
