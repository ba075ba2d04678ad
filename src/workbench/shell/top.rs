//! Top bar: menus, name of the session, undo and redo.

use egui::{Align, Button, Label, Layout, MenuBar, RichText, Ui};
use egui_material_icons::icons;

use super::menu::{Menu, MenuItem};
use super::state::AppState;
use super::stop;
use crate::model::command::{Command, ViewCommand};
use crate::theme;
use crate::widgets::{UiExt, icon_only};

/// Smallest width of the session's name (points).
const LEAST_NAME: f32 = 40.0;
/// Width of the mark of an unsaved session (points).
const UNSAVED: f32 = 72.0;
/// Height of a menu item with the space below it (points).
const LINE: f32 = 32.0;

/// Sends the commands whose shortcuts were pressed.
pub fn shortcuts(ui: &Ui, state: &mut AppState, items: &[MenuItem]) {
    let mut items: Vec<&MenuItem> = items.iter().collect();
    // A shortcut without Shift also matches with Shift, so those with Shift come first.
    items.sort_by_key(|item| item.shortcut.is_none_or(|keys| !keys.modifiers.shift));
    for item in items {
        let Some(shortcut) = item.shortcut else {
            continue;
        };
        // The shortcut of an unavailable item is left to the focused field, but never to the same key without Shift.
        if !item.enabled && !shortcut.modifiers.shift {
            continue;
        }
        let is_pressed = ui.input_mut(|input| input.consume_shortcut(&shortcut));
        if is_pressed && item.enabled {
            send(state, &item.commands);
        }
    }
}

/// Sends commands in order.
pub fn send(state: &mut AppState, commands: &[Command]) {
    for command in commands {
        state.outbox.send(command.clone());
    }
}

pub fn show(ui: &mut Ui, state: &mut AppState, items: &[MenuItem]) {
    MenuBar::new().ui(ui, |ui| {
        for menu in Menu::ALL {
            ui.menu_button(menu.title(), |ui| lines(ui, state, menu, items));
        }
        if state.model.open.is_some() {
            ui.separator();
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            right(ui, state);
            // The remaining width; a long name is truncated or omitted.
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| title(ui, state));
        });
    });
}

/// Items of a menu; a long menu scrolls in a low window.
fn lines(ui: &mut Ui, state: &mut AppState, menu: Menu, items: &[MenuItem]) {
    let own: Vec<&MenuItem> = items.iter().filter(|item| item.menu == menu).collect();
    let room = ui.ctx().content_rect().height() - 56.0;
    let mut add = |ui: &mut Ui| {
        for part in own.chunk_by(|a, b| a.group.is_some() && a.group == b.group) {
            if part.first().is_some_and(|item| item.begins) {
                ui.separator();
            }
            let mut part_of = |ui: &mut Ui| part.iter().for_each(|item| line(ui, state, item));
            match part.first().and_then(|item| item.group) {
                Some(group) => {
                    ui.menu_button(group, part_of);
                }
                None => part_of(ui),
            }
        }
    };
    if own.len() as f32 * LINE > room {
        egui::ScrollArea::vertical()
            .max_height(room)
            .show(ui, |ui| add(ui));
    } else {
        add(ui);
    }
}

fn line(ui: &mut Ui, state: &mut AppState, item: &MenuItem) {
    let mut button = Button::new(&item.title);
    if let Some(shortcut) = item.shortcut {
        button = button.shortcut_text(ui.ctx().format_shortcut(&shortcut));
    }
    if ui.add_enabled(item.enabled, button).clicked() {
        send(state, &item.commands);
        ui.close();
    }
}

fn title(ui: &mut Ui, state: &AppState) {
    let Some(open) = &state.model.open else {
        return;
    };
    let state = if open.is_unsaved() { UNSAVED } else { 0.0 };
    let room = ui.available_width() - state;
    if room < LEAST_NAME {
        return;
    }
    let name = RichText::new(&open.session().name).font(theme::strong(13.0));
    ui.scope(|ui| {
        ui.set_max_width(room);
        ui.add(Label::new(name).truncate());
    });
    if open.is_unsaved() {
        ui.muted("not saved");
    }
}

fn right(ui: &mut Ui, state: &mut AppState) {
    if state.model.open.is_some() {
        ui.allocate_space(stop::SIZE);
    }
    if icon_only(ui, icons::ICON_SEARCH, "Command palette", true).clicked() {
        state.outbox.send(ViewCommand::Palette(true));
    }
    let dark = ui.theme() == egui::Theme::Dark;
    let (icon, name, theme) = if dark {
        (
            icons::ICON_LIGHT_MODE,
            "Switch to the light theme",
            egui::ThemePreference::Light,
        )
    } else {
        (
            icons::ICON_DARK_MODE,
            "Switch to the dark theme",
            egui::ThemePreference::Dark,
        )
    };
    if icon_only(ui, icon, name, true).clicked() {
        state.outbox.send(ViewCommand::Theme(theme));
    }
    let [undo, redo] = state.model.next_steps();
    for (icon, title, step, command) in [
        (icons::ICON_REDO, "Redo", redo, Command::Redo),
        (icons::ICON_UNDO, "Undo", undo, Command::Undo),
    ] {
        let name = step.map_or_else(|| title.to_owned(), |step| format!("{title}: {step}"));
        if icon_only(ui, icon, &name, step.is_some()).clicked() {
            state.outbox.send(command);
        }
    }
}
