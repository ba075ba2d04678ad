//! Command palette: type a few letters, move with the arrow keys, press Enter.

use egui::{Key, ScrollArea, TextEdit, Ui};

use super::menu::{self, MenuItem};
use super::state::AppState;
use super::top;
use crate::model::command::ViewCommand;
use crate::widgets::{UiExt, modal};

/// Draws the palette while it is open.
pub fn show(ui: &mut Ui, state: &mut AppState) {
    let Some(mut text) = state.model.dialogs.palette.take() else {
        return;
    };
    let mut items = menu::items(state);
    items.retain(|item| matches(&item.name(), &text));
    // Unavailable items come last and are never marked.
    items.sort_by_key(|item| !item.enabled);
    let enabled = items.iter().filter(|item| item.enabled).count();
    let mut chosen = None;
    let before = text.clone();
    let ((), is_left) = modal(ui, "command palette", 480.0, |ui| {
        let field = TextEdit::singleline(&mut text)
            .hint_text("Type a command")
            .desired_width(f32::INFINITY);
        let field = ui.add(field);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Command"));
        field.request_focus();
        let marked = marked(ui, enabled, text != before);
        if ui.input(|input| input.key_pressed(Key::Enter)) {
            chosen = items[..enabled]
                .get(marked.place)
                .map(|item| item.commands.clone());
        }
        ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for (k, item) in items.iter().enumerate() {
                let line = line(ui, item, k == marked.place && item.enabled);
                if line.clicked() {
                    chosen = Some(item.commands.clone());
                }
                if k == marked.place && marked.has_moved {
                    line.scroll_to_me(None);
                }
            }
            if items.is_empty() {
                ui.muted("No matching commands");
            }
        });
    });
    let is_done = chosen.is_some() || is_left;
    if is_done {
        // The first item is marked when the palette opens again.
        let id = egui::Id::unique("marked command");
        ui.data_mut(|data| data.remove::<usize>(id));
    }
    if let Some(commands) = chosen {
        top::send(state, &commands);
    } else if is_done {
        state.outbox.send(ViewCommand::Palette(false));
    } else {
        state.model.dialogs.palette = Some(text);
    }
}

/// Item that Enter chooses.
#[derive(Debug, Clone, Copy)]
struct Marked {
    place: usize,
    has_moved: bool,
}

/// Marked item: the first one if `is_other`, otherwise moved by the arrow keys.
fn marked(ui: &Ui, count: usize, is_other: bool) -> Marked {
    let id = egui::Id::unique("marked command");
    let before = ui.data(|data| data.get_temp::<usize>(id)).unwrap_or(0);
    let pressed = |key| ui.input(|input| input.num_presses(key));
    let last = count.saturating_sub(1);
    let place = match is_other {
        true => 0,
        false => (before + pressed(Key::ArrowDown))
            .min(last)
            .saturating_sub(pressed(Key::ArrowUp)),
    };
    ui.data_mut(|data| data.insert_temp(id, place));
    Marked {
        place,
        has_moved: place != before,
    }
}

fn line(ui: &mut Ui, item: &MenuItem, is_marked: bool) -> egui::Response {
    let mut button = egui::Button::selectable(is_marked, item.name())
        .min_size(egui::vec2(ui.available_width(), 24.0));
    if let Some(shortcut) = item.shortcut {
        button = button.shortcut_text(ui.ctx().format_shortcut(&shortcut));
    }
    ui.add_enabled(item.enabled, button)
}

/// Whether the letters of `text` occur in `title` in this order, ignoring case.
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
