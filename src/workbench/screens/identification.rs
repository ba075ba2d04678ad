//! The panel of the phase Identification.

use egui::Ui;

use crate::app::State;
use crate::widgets::heading;

/// Draws the panel.
pub fn show(ui: &mut Ui, _state: &mut State) {
    heading(ui, "Identification");
}
