//! Views beside the panels: the robot in 3D, plots.

pub(crate) mod manual;
pub mod offscreen;
pub mod plots;
pub(crate) mod pulley_inspector;
pub mod report_picture;
pub mod robot_3d;
pub(crate) mod timeline;

use egui::{CentralPanel, Frame, Margin, Panel, Ui};

use crate::model::command::Outbox;
use crate::model::{Model, Selection};
use crate::theme::{self, GRID};
use robot_3d::drawing::FrameLook;

/// State of the views between frames.
#[derive(Default)]
pub struct ViewStates {
    /// Selection under the pointer, in all views.
    pub hovered: Selection,
    pub robot_3d: robot_3d::Robot3d,
    /// 3D view of two compared robots.
    pub compared_3d: robot_3d::Robot3d,
    /// 3D view of a robot over the sessions of its record.
    pub record_3d: robot_3d::Robot3d,
    pub timeline: timeline::TimelineState,
    pub plots: plots::Panes,
    pub manual: manual::Manual,
}

impl ViewStates {
    pub fn of(plots: plots::Panes) -> Self {
        let mut views = Self {
            plots,
            ..Self::default()
        };
        views.compared_3d.options.frame = FrameLook::Transparent;
        views.record_3d.options.frame = FrameLook::Transparent;
        views
    }

    /// Frees resources on the graphics card, while its context is current.
    pub fn destroy(&mut self) {
        self.robot_3d.destroy();
        self.compared_3d.destroy();
        self.record_3d.destroy();
    }
}

/// Draws the robot in 3D with the time line of the poses below, or the inspected pulley.
pub fn robot(ui: &mut Ui, model: &Model, views: &mut ViewStates, outbox: &mut Outbox) {
    if let Some(inspected) = pulley_inspector::inspected(model) {
        let (view, hovered) = (&mut views.robot_3d, &mut views.hovered);
        pulley_inspector::show(ui, model, inspected, view, hovered, outbox);
        return;
    }
    pulley_inspector::key(ui, model, outbox);
    if model.measured().is_some() {
        let frame = Frame::new().inner_margin(Margin::symmetric(2 * GRID as i8, GRID as i8));
        Panel::bottom("time line")
            .frame(frame)
            .resizable(false)
            .exact_size(timeline::HEIGHT)
            .show(ui, |ui| timeline::show(ui, model, views, outbox));
    }
    // The picture fills its own background: filling it here as well was half of all that egui fills.
    let frame = match model.open {
        Some(_) => Frame::new(),
        None => Frame::new().fill(theme::of(ui).ground),
    };
    CentralPanel::no_frame().frame(frame).show(ui, |ui| {
        let (view, hovered) = (&mut views.robot_3d, &mut views.hovered);
        robot_3d::show(ui, model, view, hovered, outbox);
    });
}
