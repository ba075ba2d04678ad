//! Centred page of text and controls.

use egui::{ScrollArea, Ui};

use crate::theme::GRID;

/// Greatest width of a text column (points).
pub const COLUMN: f32 = 640.0;

/// Draws `contents` centred, with this greatest width and space above (points); scrolls if it is higher than the
/// window.
pub fn page(ui: &mut Ui, most: f32, above: f32, contents: impl FnOnce(&mut Ui)) {
    let margin = ((ui.available_width() - most) / 2.0).max(4.0 * GRID);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.add_space(margin);
            ui.vertical(|ui| {
                ui.set_width(most.min(ui.available_width() - margin));
                ui.add_space(above);
                contents(ui);
            });
        });
    });
}
