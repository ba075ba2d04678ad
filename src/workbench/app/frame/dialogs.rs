//! Questions that have to be answered before the program goes on.

use egui::{Id, Modal, RichText, Ui};

use crate::app::commands::FileCommand;
use crate::app::state::State;
use crate::app::theme::{self, GRID};
use crate::widgets::{heading, muted, primary};

/// Draws the question that is open, if one is.
pub fn show(ui: &mut Ui, state: &mut State) {
    // Where to save is asked above it.
    if state.windows.leaving.is_some() && state.windows.save_as.is_none() {
        unsaved(ui, state);
    }
}

/// Save the changes first?
fn unsaved(ui: &mut Ui, state: &mut State) {
    let name = state
        .document
        .as_ref()
        .map_or_else(String::new, |document| document.session().name.clone());
    let modal = Modal::new(Id::unique("unsaved changes")).show(ui.ctx(), |ui| {
        ui.set_width(420.0);
        heading(ui, "Save the changes?");
        ui.label(format!("{name} has changes that no file has yet."));
        ui.add_space(2.0 * GRID);
        ui.horizontal(|ui| {
            if primary(ui, "Save", true).clicked() {
                state.outbox.send(FileCommand::Answer(Answer::Save));
            }
            if ui.button("Do not save").clicked() {
                state.outbox.send(FileCommand::Answer(Answer::Discard));
            }
            if ui.button("Cancel").clicked() {
                state.outbox.send(FileCommand::Answer(Answer::Cancel));
            }
        });
    });
    if modal.should_close() {
        state.outbox.send(FileCommand::Answer(Answer::Cancel));
    }
}

/// What to do about unsaved changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// Save them, then go on.
    Save,
    /// Go on without them.
    Discard,
    /// Do not go on.
    Cancel,
}

/// Draws what is left after the program broke down.
pub fn broken(ui: &mut Ui, state: &mut State) {
    let Some(breakdown) = state.breakdown.clone() else {
        return;
    };
    let folder = state.folders.recovery();
    ui.vertical_centered(|ui| {
        ui.set_width(640.0_f32.min(ui.available_width() - 8.0 * GRID));
        ui.add_space(ui.available_height() * 0.2);
        ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
            heading(ui, "Tautline has met an error of its own");
            ui.label("The session is kept as it was. Nothing that was measured is lost. It is in the folder");
            ui.label(RichText::new(folder.display().to_string()).font(theme::strong(13.0)));
            ui.label("and is offered for recovery when the program is started again.");
            ui.add_space(2.0 * GRID);
            muted(ui, "Please report this:");
            ui.add(egui::Label::new(RichText::new(&breakdown.what).small()).wrap().selectable(true));
            ui.add_space(2.0 * GRID);
            ui.horizontal(|ui| {
                if primary(ui, "Quit", true).clicked() {
                    ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
                }
                if ui.button("Go on").clicked() {
                    state.breakdown = None;
                }
                if ui.button("Copy the report").clicked() {
                    ui.ctx().copy_text(breakdown.what.clone());
                }
            });
        });
    });
}
