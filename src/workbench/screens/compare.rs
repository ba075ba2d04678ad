//! Two sessions side by side.

use egui::Ui;

use crate::app::State;
use crate::widgets::heading;

/// Draws the comparison.
pub fn show(ui: &mut Ui, _state: &mut State) {
    heading(ui, "Compare");
}
