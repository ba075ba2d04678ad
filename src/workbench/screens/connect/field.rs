//! Fields with their errors.

use egui::{RichText, TextEdit, Ui};
use egui_material_icons::icons;

use super::problems::{FieldId, Problems};
use crate::theme;
use crate::widgets::{UiExt, icon_button, name_text_field};

/// Width of a field (points).
const WIDTH: f32 = 240.0;

/// Grid row: name, field, and below it the error.
pub fn line(ui: &mut Ui, problems: &Problems, field: FieldId, text: &mut String) {
    edit(ui, field.names(), text, problems.of(field), false, |_| ());
}

/// Grid row for the path of a file, with a button for a file dialog; returns whether it was pressed.
pub fn file(
    ui: &mut Ui,
    problems: &Problems,
    field: FieldId,
    choose: &str,
    text: &mut String,
) -> bool {
    edit(ui, field.names(), text, problems.of(field), false, |ui| {
        icon_button(ui, icons::ICON_FOLDER_OPEN, choose, true).clicked()
    })
}

/// Grid row for a hidden text, such as a password.
pub fn secret(ui: &mut Ui, names: (&str, &str), text: &mut String) {
    edit(ui, names, text, None, true, |_| ());
}

/// Grid row with additional content beside the field.
fn edit<T>(
    ui: &mut Ui,
    (name, hint): (&str, &str),
    text: &mut String,
    problem: Option<&str>,
    is_secret: bool,
    beside: impl FnOnce(&mut Ui) -> T,
) -> T {
    ui.label(name);
    let shown = ui.vertical(|ui| {
        let width = WIDTH.min(ui.available_width());
        let edit = TextEdit::singleline(text).hint_text(hint);
        let edit = edit.password(is_secret).desired_width(width);
        let shown = ui.horizontal(|ui| (ui.add(edit), beside(ui)));
        let (response, beside) = shown.inner;
        let value = match is_secret {
            true => "\u{2022}".repeat(text.chars().count()),
            false => text.clone(),
        };
        name_text_field(&response, name, &value);
        // An empty field is not an error; the footer of the dialog names what is missing.
        if let Some(problem) = problem.filter(|_| !text.trim().is_empty()) {
            let colour = theme::of(ui).bad;
            let sentence = tautline_workflow::wording::sentence(&format!("{problem}."));
            let text = RichText::new(sentence).small().color(colour);
            ui.wrapped(text);
        }
        beside
    });
    ui.end_row();
    shown.inner
}

/// Name and text in one line.
pub fn labelled(ui: &mut Ui, name: &str, text: &str) {
    ui.horizontal_wrapped(|ui| {
        ui.muted(name);
        ui.label(RichText::new(text).monospace());
    });
}
