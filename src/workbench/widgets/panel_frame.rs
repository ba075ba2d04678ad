//! Frames of panels, and tabs for one panel at a time.

use egui::{CentralPanel, Frame, Margin, Panel, Ui};

use crate::model::part::ScreenPart;
use crate::theme::{self, GRID};

/// Fill and margin of a panel.
pub fn panel_frame(ui: &Ui) -> Frame {
    Frame::new()
        .fill(theme::of(ui).panel)
        .inner_margin(Margin::same(3 * GRID as i8))
}

/// Tabs with the titles of the parts, and below them the chosen part, drawn by `draw`.
pub fn one_part(
    ui: &mut Ui,
    chosen: &mut ScreenPart,
    parts: [(ScreenPart, &str); 3],
    draw: impl FnOnce(&mut Ui, ScreenPart),
) {
    let frame = panel_frame(ui);
    Panel::top("tabs of parts").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            for (part, title) in parts {
                ui.selectable_value(chosen, part, title);
            }
        });
    });
    CentralPanel::no_frame()
        .frame(frame)
        .show(ui, |ui| draw(ui, *chosen));
}
