//! The log window: all messages.

use egui::{ScrollArea, Ui, Window};
use tautline_workflow::wording::local_time::time_of_day;

use super::state::AppState;
use crate::model::messages::Severity;
use crate::theme;
use crate::widgets::UiExt;

/// Draws the log while it is open.
pub fn show(ui: &mut Ui, state: &mut AppState) {
    let mut open = state.model.dialogs.log;
    Window::new("Log")
        .open(&mut open)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ui.ctx().content_rect().center())
        .default_size([640.0, 360.0])
        .show(ui.ctx(), |ui| {
            if state.model.messages.all().is_empty() {
                ui.muted("Nothing has happened yet.");
            }
            ScrollArea::vertical()
                .auto_shrink(false)
                .stick_to_bottom(true)
                .show(ui, |ui| {
                    for message in state.model.messages.all() {
                        let colour = match message.severity {
                            Severity::Info => theme::of(ui).text,
                            Severity::Warning => theme::of(ui).warning,
                            Severity::Error => theme::of(ui).bad,
                        };
                        ui.horizontal_wrapped(|ui| {
                            ui.muted(&time_of_day(message.time));
                            ui.colored_label(colour, &message.text);
                        });
                    }
                });
        });
    state.model.dialogs.log = open;
}
