//! The description of the robot: platform, cables, home pose, instruments and their noise.

mod cable;
mod common;
mod field;
mod instruments;

use egui::Ui;

use crate::screens::bench_panel::Bench;
use crate::widgets::muted;

/// Draws the part.
pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    muted(
        ui,
        "Every number is checked as it is typed, and the 3D view follows. What is not known yet may be rough: identification finds the pulleys.",
    );
    common::platform(ui, bench);
    cable::show(ui, bench);
    common::winches(ui, bench);
    common::home(ui, bench);
    instruments::show(ui, bench);
}
