//! The start screen: what one can begin with.

use std::path::PathBuf;

use egui::{Key, RichText, TextEdit, Ui};
use egui_material_icons::icons;

use crate::app::State;
use crate::app::commands::FileCommand;
use crate::app::theme::{self, GRID};
use crate::widgets::{icon_button, muted, primary, section};

/// What the start screen remembers.
#[derive(Debug, Default)]
pub struct Remembered {
    path: String,
}

/// Draws the start screen.
pub fn show(ui: &mut Ui, state: &mut State) {
    let width = 560.0_f32.min(ui.available_width() - 8.0 * GRID);
    ui.vertical_centered(|ui| {
        ui.set_width(width);
        ui.add_space((ui.available_height() * 0.14).max(6.0 * GRID));
        ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
            ui.label(RichText::new("Tautline").font(theme::strong(32.0)));
            muted(ui, "Find where the pulleys of a cable robot really are, and what its model still gets wrong.");
            ui.add_space(4.0 * GRID);
            begin(ui, state);
            section(ui, "Open a session, a robot.json or a dataset folder");
            open(ui, state);
        });
    });
}

fn begin(ui: &mut Ui, state: &mut State) {
    ui.horizontal(|ui| {
        if primary(ui, "Try the demo robot", true).clicked() {
            state.outbox.send(FileCommand::TryDemo);
        }
        muted(
            ui,
            "A simulated robot with a hidden fault: all five phases in five minutes.",
        );
    });
}

fn open(ui: &mut Ui, state: &mut State) {
    let path = &mut state.screens.start.path;
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(path)
            .hint_text("Path, or drop a file on the window")
            .desired_width(360.0);
        let field = ui.add(field);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Path"));
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let typed = !path.trim().is_empty();
        if (ui.add_enabled(typed, egui::Button::new("Open")).clicked() || entered) && typed {
            state
                .outbox
                .send(FileCommand::Open(PathBuf::from(path.trim())));
        }
        if icon_button(ui, icons::ICON_FOLDER_OPEN, "Browse…", true).clicked() {
            state.outbox.send(FileCommand::AskOpen);
        }
    });
}
