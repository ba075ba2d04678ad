//! The robot in 3D.

use egui::Ui;

use crate::app::State;
use crate::widgets::empty;

/// Draws the robot of the open session.
pub fn show(ui: &mut Ui, _state: &mut State) {
    empty(ui, "The robot");
}
