//! Plots below the 3D view.

use egui::Ui;

use crate::app::State;
use crate::widgets::empty;

/// Draws the plots of the present screen.
pub fn show(ui: &mut Ui, _state: &mut State) {
    empty(
        ui,
        "Residuals of every cable appear here once poses are identified.",
    );
}
