//! Plots below the 3D view, and small plots for panels.

mod canvas;
mod draw;
pub mod figure;
mod hit;
mod scale;
pub mod small;
mod thin;

use egui::Ui;

use crate::app::State;
use crate::widgets::empty;

/// Label of an axis along which poses stand.
pub const POSE: &str = "Pose";

/// Draws the plots of the present screen.
pub fn show(ui: &mut Ui, _state: &mut State) {
    empty(
        ui,
        "Residuals of every cable appear here once poses are identified.",
    );
}
