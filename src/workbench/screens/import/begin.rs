//! Start of an import: choice of a file, or of the measured robot.

use egui::Ui;
use tautline_core::robot::presets;

use super::PanelState;
use super::files::path_row;
use crate::model::Model;
use crate::model::command::{FileCommand, Outbox, RecordingCommand};
use crate::screens::start::template_buttons;
use crate::theme::GRID;
use crate::widgets::{COLUMN, UiExt, icon_button, page};
use egui_material_icons::icons;

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    page(ui, COLUMN, 8.0 * GRID, |ui| {
        ui.heading("Import files of other programs");
        if model.open.is_some() {
            file(ui, panel, outbox);
        } else {
            robot(ui, model, panel, outbox);
        }
    });
}

fn file(ui: &mut Ui, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.muted("Logs of the controller, motion capture, lists of points, spreadsheets, MATLAB and NumPy files: the content tells what a file is. Drop it on the window, or open it here.");
    ui.add_space(2.0 * GRID);
    let size = egui::vec2(ui.available_width(), 7.0 * GRID);
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        path_row(ui, &mut panel.path, size.x, outbox);
    });
}

fn robot(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let waiting = model.importing.waiting.iter();
    let files: Vec<&str> = waiting.map(|source| source.file.as_str()).collect();
    if files.is_empty() {
        file(ui, panel, outbox);
    } else {
        ui.muted(&files.join(", "));
    }
    ui.section("Which robot was measured?");
    ui.muted("Its description says how many cables there are and what their readings should be. Drop a session or a robot.json on the window, or start with a known robot:");
    ui.add_space(GRID);
    ui.horizontal_wrapped(|ui| {
        for preset in presets::NAMES.into_iter().filter_map(presets::find) {
            let button = ui.button(&preset.robot.name);
            if button.on_hover_text(preset.summary).clicked() {
                let robot = Box::new(preset.robot);
                outbox.send(RecordingCommand::UseRobot(robot));
            }
        }
    });
    ui.muted("Or begin with a new one, and describe it later:");
    template_buttons(ui, outbox);
    ui.add_space(GRID);
    if icon_button(
        ui,
        icons::ICON_FOLDER_OPEN,
        "Open a session or a robot…",
        true,
    )
    .clicked()
    {
        outbox.send(FileCommand::AskOpen);
    }
}
