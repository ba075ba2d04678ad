//! Alert with the last error, in the lower left corner, until it is dismissed or its cause is resolved.

use egui::{Align2, Area, Frame, Id, Margin, Order, Stroke, Ui, Vec2};
use egui_material_icons::icons;

use super::AppState;
use crate::model::command::{FileCommand, ViewCommand};
use crate::theme::{self, GRID};
use crate::widgets::UiExt;

/// Greatest width of the text (points).
const WIDTH: f32 = 560.0;

/// Draws the alert, if any, as an overlay, so that nothing moves under the pointer.
pub fn show(ui: &Ui, state: &mut AppState) {
    let Some(alert) = state.model.messages.alert() else {
        return;
    };
    let palette = theme::of(ui);
    let frame = Frame::new()
        .fill(palette.panel.lerp_to_gamma(palette.bad, 0.18))
        .stroke(Stroke::new(1.0, palette.bad))
        .corner_radius(4.0)
        .inner_margin(Margin::symmetric(3 * GRID as i8, 2 * GRID as i8));
    let width = WIDTH.min(ui.ctx().content_rect().width() - 48.0 * GRID);
    let area = Area::new(Id::unique("alert"))
        .order(Order::Tooltip)
        .anchor(Align2::LEFT_BOTTOM, Vec2::new(2.0 * GRID, -GRID));
    area.show(ui.ctx(), |ui| {
        frame.show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(icons::ICON_ERROR.rich_text().size(18.0).color(palette.bad));
                ui.scope(|ui| {
                    ui.set_max_width(width);
                    ui.wrapped(&alert.text);
                });
                let elsewhere = state.model.messages.failed_to_save() && state.model.open.is_some();
                if elsewhere && ui.button("Save as…").clicked() {
                    state.outbox.send(FileCommand::AskSaveAs);
                }
                if ui.button("Dismiss").clicked() {
                    state.outbox.send(ViewCommand::Dismiss);
                }
            });
        });
    });
}
