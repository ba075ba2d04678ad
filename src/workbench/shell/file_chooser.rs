//! The window that asks for a file where the desktop has no dialog for it.

use egui::Ui;

use super::state::State;
use crate::widgets::backdrop;

/// Draws it while it is open; whether it is. It stands in for the dialog that asks for the file.
pub fn show(ui: &Ui, state: &mut State) -> bool {
    let Some(mut chooser) = state.model.dialogs.chooser.take() else {
        return false;
    };
    backdrop(ui, "behind the file chooser");
    let is_chosen = match chooser.window.show(ui.ctx()).state() {
        egui_file::State::Open => {
            state.model.dialogs.chooser = Some(chooser);
            return true;
        }
        egui_file::State::Selected => true,
        egui_file::State::Closed | egui_file::State::Cancelled => false,
    };
    if let Some(path) = chooser.window.path().filter(|_| is_chosen) {
        let command = (chooser.choice.command)(path.to_owned());
        state.outbox.send(command);
    }
    true
}
