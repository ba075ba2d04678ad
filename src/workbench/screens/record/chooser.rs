//! Choice of the record's folder: typed, in a dialog, or dropped on the window.

use std::path::PathBuf;

use egui::{Align, Button, Label, Layout, RichText, Ui};
use egui_material_icons::icons;
use tautline_workflow::report::ReportFormat;

use super::PanelState;
use crate::model::Model;
use crate::model::command::{Outbox, RecordCommand, ReportCommand, ViewCommand};
use crate::theme::{self, GRID};
use crate::widgets::{icon_button, path_field};

pub(super) fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let open = model.record.open();
    ui.horizontal(|ui| {
        ui.heading("Record of a robot");
        if let Some(open) = open {
            ui.label(RichText::new(open.record.title()).font(theme::strong(13.0)));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if icon_button(ui, icons::ICON_ARROW_BACK, "Back", true).clicked() {
                outbox.send(ViewCommand::Go(model.previous_screen()));
            }
            let is_open = open.is_some();
            let name = "Save report…";
            if icon_button(ui, icons::ICON_DESCRIPTION, name, is_open).clicked() {
                outbox.send(ReportCommand::AskSave(ReportFormat::FOR_PAPER));
            }
            if icon_button(ui, icons::ICON_DOWNLOAD, "Save table…", is_open).clicked() {
                outbox.send(RecordCommand::AskSaveTable);
            }
        });
    });
    ui.add_space(GRID);
    ui.horizontal(|ui| match model.record.folder() {
        Some(folder) => {
            if ui.button("Change").clicked() {
                // The path remains, for editing.
                panel.path = folder.display().to_string();
                outbox.send(RecordCommand::Close);
            }
            let is_read = model.record.result().is_some();
            if icon_button(ui, icons::ICON_REFRESH, "Read again", is_read).clicked() {
                outbox.send(RecordCommand::Open(folder.to_owned()));
            }
            let place = RichText::new(folder.display().to_string());
            ui.add(Label::new(place.color(theme::of(ui).muted)).truncate());
        }
        None => choose(ui, &mut panel.path, outbox),
    });
}

fn choose(ui: &mut Ui, path: &mut String, outbox: &mut Outbox) {
    let hint = "Folder with the sessions of one robot, or drop it on the window";
    let width = (ui.available_width() - 220.0).clamp(160.0, 560.0);
    let entered = path_field(ui, "Folder of the record", hint, path, width);
    let typed = !path.trim().is_empty();
    let open = ui.add_enabled(typed, Button::new("Open"));
    if (open.clicked() || entered) && typed {
        outbox.send(RecordCommand::Open(PathBuf::from(path.trim())));
    }
    if icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked() {
        outbox.send(RecordCommand::Ask);
    }
}
