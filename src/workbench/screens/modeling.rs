//! The panel of the phase Modeling.

use egui::Ui;

use crate::app::State;
use crate::widgets::heading;

/// Draws the panel.
pub fn show(ui: &mut Ui, _state: &mut State) {
    heading(ui, "Modeling");
}
