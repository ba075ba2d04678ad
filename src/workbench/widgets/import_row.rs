//! Row for importing a file: path and file dialog.

use std::path::PathBuf;

use egui::{Align, Layout, Role, TextEdit, Ui, Vec2, WidgetInfo};
use egui_material_icons::icons;

use super::button::{entered, icon_button, icon_only};
use crate::theme::GRID;

/// Choice of a file to import.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Import {
    Path(PathBuf),
    /// With a file dialog.
    Browse,
}

/// Draws the row for a file such as "winch.csv"; `path` is the typed path.
pub fn import_row(ui: &mut Ui, file: &str, path: &mut String) -> Option<Import> {
    let mut answer = None;
    let size = Vec2::new(ui.available_width(), 7.0 * GRID);
    let layout = Layout::right_to_left(Align::Center);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        let dialog = format!("Browse for {file}");
        if icon_only(ui, icons::ICON_FOLDER_OPEN, &dialog, true).clicked() {
            answer = Some(Import::Browse);
        }
        let typed = !path.trim().is_empty();
        let pressed = icon_button(ui, icons::ICON_UPLOAD_FILE, "Import", typed).clicked();
        let name = format!("Path of {file}");
        let hint = format!("Path of {file}, or drop it here");
        let width = ui.available_width();
        let entered = path_field(ui, &name, &hint, path, width);
        if typed && (pressed || entered) {
            answer = Some(Import::Path(PathBuf::from(path.trim())));
        }
    });
    answer
}

/// Field for a path, with name and hint; returns whether Enter was pressed.
pub fn path_field(ui: &mut Ui, name: &str, hint: &str, path: &mut String, width: f32) -> bool {
    let field = TextEdit::singleline(path)
        .hint_text(hint)
        .desired_width(width);
    let field = ui.add(field);
    field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, name));
    entered(&field)
}
