//! What is drawn beside the panels: the robot in 3D, plots.

pub mod plots;
pub mod robot_3d;
pub mod timeline;

use egui::{CentralPanel, Frame, Margin, Panel, Ui};

use crate::app::State;
use crate::app::theme::{self, GRID};

/// What the views remember.
#[derive(Default)]
pub struct Views {
    /// Of the robot in 3D.
    pub robot_3d: robot_3d::Robot3d,
    /// Of the two robots in 3D that are compared.
    pub compared_3d: robot_3d::Robot3d,
    /// Of the time line.
    pub timeline: timeline::Remembered,
    /// Of the plots.
    pub plots: plots::Panes,
}

impl Views {
    /// Frees what lies on the graphics card, while its context is current.
    pub fn destroy(&mut self) {
        self.robot_3d.destroy();
        self.compared_3d.destroy();
    }
}

/// Draws the robot in 3D, and below it the time line of what was measured.
pub fn robot(ui: &mut Ui, state: &mut State) {
    let palette = theme::of(ui);
    let measured = state
        .document
        .as_ref()
        .is_some_and(|document| !document.session().measurements.is_empty());
    if measured {
        let frame = Frame::new()
            .fill(palette.panel)
            .inner_margin(Margin::symmetric(2 * GRID as i8, GRID as i8));
        Panel::bottom("time line")
            .frame(frame)
            .resizable(false)
            .exact_size(timeline::HEIGHT)
            .show(ui, |ui| timeline::show(ui, state));
    }
    CentralPanel::no_frame()
        .frame(Frame::new().fill(palette.ground))
        .show(ui, |ui| robot_3d::show(ui, state));
}
