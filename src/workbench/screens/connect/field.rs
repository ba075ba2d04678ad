//! Fields with what is wrong with them.

use egui::{RichText, TextEdit, Ui, WidgetInfo};

use crate::theme;
use crate::widgets::muted;

/// Width of a field (points).
const WIDTH: f32 = 240.0;

/// A line of a grid: name, field, and below that what is wrong.
pub fn line(ui: &mut Ui, names: (&str, &str), text: &mut String, problem: Option<&str>) {
    edit(ui, names, text, (problem, false));
}

/// The same for a text that is not shown.
pub fn secret(ui: &mut Ui, names: (&str, &str), text: &mut String) {
    edit(ui, names, text, (None, true));
}

fn edit(
    ui: &mut Ui,
    (name, hint): (&str, &str),
    text: &mut String,
    (problem, is_secret): (Option<&str>, bool),
) {
    ui.label(name);
    ui.vertical(|ui| {
        let width = WIDTH.min(ui.available_width());
        let edit = TextEdit::singleline(text).hint_text(hint);
        let response = ui.add(edit.password(is_secret).desired_width(width));
        let value = match is_secret {
            true => "\u{2022}".repeat(text.chars().count()),
            false => text.clone(),
        };
        response.widget_info(|| {
            let mut info = WidgetInfo::text_edit(true, value.clone(), value.clone(), "");
            info.label = Some(name.to_owned());
            info
        });
        if let Some(problem) = problem {
            let colour = theme::of(ui).bad;
            let sentence = tautline_workflow::wording::sentence(&format!("{problem}."));
            let text = RichText::new(sentence).small().color(colour);
            ui.add(egui::Label::new(text).wrap());
        }
    });
    ui.end_row();
}

/// A name and what belongs to it, in one line.
pub fn labelled(ui: &mut Ui, name: &str, text: &str) {
    ui.horizontal_wrapped(|ui| {
        muted(ui, name);
        ui.label(RichText::new(text).monospace());
    });
}
