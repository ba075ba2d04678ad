//! A row for importing a file: typed path, dialog.

use std::path::PathBuf;

use egui::{Align, Key, Layout, Role, TextEdit, Ui, WidgetInfo};
use egui_material_icons::icons;

use super::button::{icon_button, icon_only};
use crate::app::theme::GRID;

/// How a file is to be imported.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Import {
    /// From a path.
    Path(PathBuf),
    /// By a dialog.
    Browse,
}

/// Draws the row for a file such as "winch.csv"; `path` is what is typed.
pub fn import_row(ui: &mut Ui, file: &str, path: &mut String) -> Option<Import> {
    let mut answer = None;
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.set_max_height(6.0 * GRID);
        let dialog = format!("Browse for {file}");
        if icon_only(ui, icons::ICON_FOLDER_OPEN, &dialog, true).clicked() {
            answer = Some(Import::Browse);
        }
        let typed = !path.trim().is_empty();
        let pressed = icon_button(ui, icons::ICON_UPLOAD_FILE, "Import", typed).clicked();
        let name = format!("Path of {file}");
        let field = TextEdit::singleline(path)
            .hint_text(format!("Path of {file}, or drop it on the window"))
            .desired_width(ui.available_width());
        let field = ui.add(field);
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, &name));
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if typed && (pressed || entered) {
            answer = Some(Import::Path(PathBuf::from(path.trim())));
        }
    });
    answer
}
