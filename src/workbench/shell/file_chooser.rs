//! The program's own file chooser, for desktops without one.

use egui::{Context, Id, LayerId, Order, Role, Ui};

use super::state::AppState;
use crate::model::command::file_choice::WINDOW;
use crate::widgets::backdrop;

/// Draws the file chooser and returns whether it is open. It replaces the dialog that asked for the file.
pub fn show(ui: &Ui, state: &mut AppState) -> bool {
    let Some(mut chooser) = state.model.dialogs.chooser.take() else {
        return false;
    };
    backdrop(ui, "behind the file chooser");
    let shown = chooser.window.show(ui.ctx()).state();
    name_fields(ui.ctx());
    let is_chosen = match shown {
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

/// Names the two fields for screen readers; egui_file leaves them unnamed.
fn name_fields(context: &Context) {
    let layer = LayerId::new(Order::Middle, Id::unique(WINDOW));
    let widgets: Vec<Id> = context.viewport(|viewport| {
        let widgets = viewport.this_pass.widgets.get_layer(layer);
        widgets.map(|widget| widget.id).collect()
    });
    let mut names = ["Folder", "File name"].into_iter();
    for id in widgets {
        context.accesskit_node_builder(id, |node| {
            if node.role() == Role::TextInput
                && let Some(name) = names.next()
            {
                node.set_label(name);
            }
        });
    }
}
