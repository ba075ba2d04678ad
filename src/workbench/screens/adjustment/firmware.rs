//! Correction of the user's firmware or simulator file: changed values, and effects that the file cannot express.

use egui::Ui;
use egui_material_icons::icons;

use crate::model::Model;
use crate::model::command::{CorrectedFile, Outbox, PlotCommand, PlotFile, RobotCommand};
use crate::widgets::{Cell, TableColumn, UiExt, icon_button, table};
use tautline_workflow::wording::units::fixed;

pub fn show(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    ui.section("Firmware or simulator");
    ui.muted("The identified values in your config.g, printer.cfg, maslow.yaml or model of MuJoCo, ROS or Gazebo. The file itself stays as it is.");
    let corrected = model.corrected_file();
    let corrected = corrected.map(|one| (&one.file, &one.result));
    ui.horizontal_wrapped(|ui| {
        if icon_button(ui, icons::ICON_FOLDER_OPEN, "Choose file…", true).clicked() {
            outbox.send(RobotCommand::AskFirmware);
        }
        if let Some((file, Ok(corrected))) = corrected {
            if icon_button(ui, icons::ICON_CONTENT_COPY, "Copy lines", true).clicked() {
                ui.ctx().copy_text(corrected.lines.clone());
            }
            if icon_button(ui, icons::ICON_DOWNLOAD, "Save as…", true).clicked() {
                let text = PlotFile::Text(corrected.written.text.clone());
                outbox.send(PlotCommand::AskSave(file.clone(), text));
            }
        }
    });
    match corrected {
        None => {}
        Some((_, Err(error))) => ui.bad(error),
        Some((file, Ok(corrected))) => changes(ui, file, corrected),
    }
}

fn changes(ui: &mut Ui, file: &str, corrected: &CorrectedFile) {
    let columns = [
        TableColumn::words("Value"),
        TableColumn::number("Old", ""),
        TableColumn::number("New", ""),
        TableColumn::number("±", ""),
        TableColumn::words("Unit"),
        TableColumn::number("Gain", "mm"),
    ];
    let values = corrected.written.values.iter();
    let rows: Vec<Vec<Cell>> = values
        .map(|value| {
            let row = &value.parameter.row;
            let number = |number: f64| format!("{number:.*}", row.digits);
            let cells = [
                value.parameter.key.clone(),
                number(value.parameter.value),
                value.new.clone(),
                value.sd.map_or_else(|| "–".to_owned(), number),
                row.unit.0.to_owned(),
                (value.gain_m).map_or_else(String::new, |gain_m| fixed(1e3 * gain_m, 2)),
            ];
            cells.map(Cell::new).into()
        })
        .collect();
    ui.label(corrected.written.loss_in_words());
    ui.muted(&format!("{file}: {} values change", rows.len()));
    table(ui, &columns, &rows, None);
    ui.muted("±: the standard deviation. Gain: what the position error grows by if this value alone stays.");
}
