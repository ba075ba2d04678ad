//! The last error, across the window, until the operator has seen it.

use egui::{Align, Frame, Label, Layout, Margin, Panel, Ui};
use egui_material_icons::icons;

use super::State;
use crate::model::command::ViewCommand;
use crate::theme::{self, GRID};

/// Draws it, if there is one.
pub fn show(ui: &mut Ui, state: &mut State) {
    let Some(text) = state.model.messages.alert().map(|alert| alert.text.clone()) else {
        return;
    };
    let palette = theme::of(ui);
    let frame = Frame::new()
        .fill(palette.panel.lerp_to_gamma(palette.bad, 0.18))
        .inner_margin(Margin::symmetric(3 * GRID as i8, GRID as i8));
    Panel::top("alert").frame(frame).show(ui, |ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.button("Dismiss").clicked() {
                state.outbox.send(ViewCommand::Dismiss);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.label(icons::ICON_ERROR.rich_text().size(18.0).color(palette.bad));
                ui.add(Label::new(text).wrap());
            });
        });
    });
}
