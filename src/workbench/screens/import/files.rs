//! List of files.

use egui::{Align, Layout, RichText, Ui};
use egui_material_icons::icons;

use super::PanelState;
use crate::model::command::{Outbox, RecordingCommand};
use crate::model::importing::OpenImport;
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, icon_button, icon_only, path_field};

pub fn show(ui: &mut Ui, import: &OpenImport, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.horizontal(|ui| {
        ui.heading("Import");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if icon_button(ui, icons::ICON_CLOSE, "Cancel import", true).clicked() {
                outbox.send(RecordingCommand::Discard);
            }
            ui.add_space(2.0 * GRID);
            let width = (ui.available_width() - 3.0 * GRID).min(480.0);
            path_row(ui, &mut panel.path, width, outbox);
        });
    });
    for (k, source) in import.draft.sources().iter().enumerate() {
        ui.horizontal(|ui| {
            let path = std::path::Path::new(&source.file);
            let name = path.file_name().unwrap_or(path.as_os_str());
            let name = name.to_string_lossy();
            let remove = format!("Remove {name}");
            if icon_only(ui, icons::ICON_CLOSE, &remove, true).clicked() {
                outbox.send(RecordingCommand::Remove(k));
            }
            ui.label(RichText::new(&*name).font(theme::strong(13.0)))
                .on_hover_text(&source.file);
            let series = source.series.iter();
            let channels: usize = series
                .clone()
                .map(|one| one.channels.len() + one.texts.len())
                .sum();
            let rows: usize = series.map(|one| one.rows).sum();
            ui.muted(&format!(
                "{}, {rows} rows, {channels} channels",
                source.format.name()
            ));
        });
    }
}

/// Field of this width for the path of a file, with a file dialog; for a layout from right to left.
pub fn path_row(ui: &mut Ui, path: &mut String, width: f32, outbox: &mut Outbox) {
    let right = ui.available_width();
    if icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked() {
        outbox.send(RecordingCommand::Ask);
    }
    let typed = !path.trim().is_empty();
    let pressed = icon_button(ui, icons::ICON_ADD, "Add", typed).clicked();
    let used = right - ui.available_width();
    let name = "Path of a file to import";
    let hint = "Path of a file or folder, or drop it here";
    let entered = path_field(ui, name, hint, path, (width - used).max(120.0));
    if typed && (pressed || entered) {
        outbox.send(RecordingCommand::Read(path.trim().into()));
        path.clear();
    }
}
