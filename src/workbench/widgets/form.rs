//! Forms: labels on the left, fields on the right.

use egui::{ComboBox, Grid, Response, Role, TextEdit, Ui, WidgetInfo};

use crate::theme::GRID;

/// Grid of labels and fields.
pub fn form(name: &str) -> Grid {
    let grid = Grid::new(name).num_columns(2);
    grid.spacing([3.0 * GRID, 1.5 * GRID])
}

/// Row of a form with a text of one line.
pub fn text_row(ui: &mut Ui, name: &str, text: &mut String, hint: &str, width: f32) {
    let label = ui.label(name);
    let field = TextEdit::singleline(text).hint_text(hint);
    ui.add(field.desired_width(width)).labelled_by(label.id);
    ui.end_row();
}

/// Draws a combo box with an accessible name.
pub fn combo_box(
    ui: &mut Ui,
    list: ComboBox,
    name: &str,
    selected: &str,
    add: impl FnOnce(&mut Ui),
) {
    let shown = list.selected_text(selected).show_ui(ui, add);
    name_combo_box(&shown.response, name);
}

/// Gives a combo box an accessible name.
pub fn name_combo_box(list: &Response, name: &str) {
    list.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
}

/// Gives a text field an accessible name.
pub fn name_text_field(field: &Response, name: &str, text: &str) {
    field.widget_info(|| {
        let mut info = WidgetInfo::text_edit(field.enabled(), text, text, "");
        info.label = Some(name.to_owned());
        info
    });
}
