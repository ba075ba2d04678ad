//! The recipe as a file.

use egui::{Align, Layout, Role, TextEdit, Ui, Vec2, WidgetInfo};
use egui_material_icons::icons;

use super::{Bench, PanelState};
use crate::model::command::RecordingCommand;
use crate::theme::GRID;
use crate::widgets::{icon_button, icon_only, muted, section};

/// Draws the part.
pub fn show(ui: &mut Ui, bench: &mut Bench<'_>, panel: &mut PanelState) {
    section(ui, "Recipe");
    muted(ui, bench.open.draft.origin());
    muted(
        ui,
        "The session keeps it for the next file. As a file it serves other sessions and `tautline import --recipe`.",
    );
    let path = &mut panel.recipe;
    let size = Vec2::new(ui.available_width(), 7.0 * GRID);
    ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
        if icon_only(ui, icons::ICON_SAVE_AS, "Save the recipe as…", true).clicked() {
            bench.outbox.send(RecordingCommand::AskSaveRecipe);
        }
        if icon_only(ui, icons::ICON_FOLDER_OPEN, "Browse for a recipe", true).clicked() {
            bench.outbox.send(RecordingCommand::AskRecipe);
        }
        let typed = !path.trim().is_empty();
        if icon_button(ui, icons::ICON_SAVE, "Save recipe", typed).clicked() {
            let path = path.trim().into();
            bench.outbox.send(RecordingCommand::SaveRecipe(path));
        }
        if icon_button(ui, icons::ICON_UPLOAD_FILE, "Use", typed).clicked() {
            let path = path.trim().into();
            bench.outbox.send(RecordingCommand::UseRecipe(path));
        }
        let field = TextEdit::singleline(path)
            .hint_text("Path of a recipe")
            .desired_width(ui.available_width());
        let field = ui.add(field);
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Path of the recipe"));
    });
}
