//! The command palette: type a few letters, press Enter.

use egui::{Key, Modal, ScrollArea, TextEdit, Ui};

use super::menu::{self, Item};
use super::state::State;
use crate::model::command::ViewCommand;
use crate::widgets::muted;

/// Draws the palette while it is open.
pub fn show(ui: &mut Ui, state: &mut State) {
    let Some(mut text) = state.model.dialogs.palette.take() else {
        return;
    };
    let items: Vec<Item> = menu::items(state)
        .into_iter()
        .filter(|item| item.enabled && matches(&item.title, &text))
        .collect();
    let mut chosen = None;
    let modal = Modal::new(egui::Id::unique("command palette")).show(ui.ctx(), |ui| {
        ui.set_width(480.0);
        let field = TextEdit::singleline(&mut text)
            .hint_text("Type a command")
            .desired_width(f32::INFINITY);
        let field = ui.add(field);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Command"));
        field.request_focus();
        if ui.input(|input| input.key_pressed(Key::Enter)) {
            chosen = items.first().map(|item| item.command.clone());
        }
        ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for (k, item) in items.iter().enumerate() {
                if line(ui, item, k == 0) {
                    chosen = Some(item.command.clone());
                }
            }
            if items.is_empty() {
                muted(ui, "No matching commands");
            }
        });
    });
    if let Some(command) = chosen {
        state.outbox.send(command);
    } else if modal.should_close() {
        state.outbox.send(ViewCommand::Palette(false));
    } else {
        state.model.dialogs.palette = Some(text);
    }
}

fn line(ui: &mut Ui, item: &Item, first: bool) -> bool {
    let mut button = egui::Button::selectable(first, &item.title)
        .min_size(egui::vec2(ui.available_width(), 24.0));
    if let Some(shortcut) = item.shortcut {
        button = button.shortcut_text(ui.ctx().format_shortcut(&shortcut));
    }
    ui.add(button).clicked()
}

/// Whether the letters of `text` occur in `title` in their order, case aside.
fn matches(title: &str, text: &str) -> bool {
    let mut letters = title.chars().flat_map(char::to_lowercase);
    text.chars()
        .filter(|c| !c.is_whitespace())
        .flat_map(char::to_lowercase)
        .all(|wanted| letters.any(|c| c == wanted))
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn letters_match_in_their_order() {
        assert!(matches("Save as…", "sva"));
        assert!(matches("Identify", ""));
        assert!(!matches("Save", "evas"));
    }
}
