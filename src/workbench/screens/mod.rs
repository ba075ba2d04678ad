//! Screens: a panel for each phase, the start screen, the comparison and others.

pub mod adjustment;
mod bench_panel;
pub mod compare;
pub mod connect;
mod footer;
pub mod gallery;
pub mod hypothesis;
pub mod identification;
pub mod import;
pub mod measuring;
pub mod modeling;
pub mod precalibration;
pub mod record;
pub mod simulator;
pub mod start;
pub mod which_sensor;

use egui::{Frame, Margin, Panel, ScrollArea, Ui};

use crate::model::command::Outbox;
use crate::model::part::ScreenPart;
use crate::model::phase::{Phase, Screen};
use crate::model::{Model, OpenSession, next_step};
use crate::theme::GRID;

/// State of all panels between frames.
#[derive(Debug, Default)]
pub struct PanelStates {
    /// Part shown in a small window.
    pub part: ScreenPart,
    pub start: start::PanelState,
    pub measuring: measuring::PanelState,
    pub adjustment: adjustment::PanelState,
    pub identification: identification::PanelState,
    pub precalibration: precalibration::PanelState,
    pub modeling: modeling::PanelState,
    pub new_robot: modeling::new_robot::Draft,
    /// Draft of the connection dialog; `None` while it is closed.
    pub connect: Option<Box<connect::Draft>>,
    pub compare: compare::PanelState,
    pub record: record::PanelState,
    pub import: import::PanelState,
    pub which_sensor: which_sensor::PanelState,
    pub simulator: simulator::PanelState,
    pub gallery: gallery::PanelState,
    /// Screen shown last; `visits` counts its changes.
    shown: Option<VisitKey>,
    visits: u64,
}

/// Session, screen, and half of the panel of the identification.
type VisitKey = (Option<u64>, Screen, identification::IdentificationTab);

impl PanelStates {
    /// Number of screen changes, which is part of the ids of scroll areas, so that each screen begins at its top.
    pub fn visit(&mut self, model: &Model) -> u64 {
        let session = model.open.as_ref().map(OpenSession::id);
        let shown = Some((session, model.screen, self.identification.tab));
        self.visits += u64::from(shown != self.shown);
        self.shown = shown;
        self.visits
    }
}

/// Draws the panel of a phase, with its footer, which does not scroll.
pub fn phase(
    ui: &mut Ui,
    model: &Model,
    panels: &mut PanelStates,
    outbox: &mut Outbox,
    phase: Phase,
) {
    if let Some(step) = next_step::of(model, phase, panels.measuring.poses) {
        let frame = Frame::new().inner_margin(Margin {
            top: 2 * GRID as i8,
            ..Margin::ZERO
        });
        Panel::bottom("foot of the phase")
            .frame(frame)
            .resizable(false)
            .show(ui, |ui| footer::show(ui, step, outbox));
    }
    let visit = panels.visit(model);
    let area = ScrollArea::vertical().id_salt(visit).auto_shrink(false);
    area.show(ui, |ui| match phase {
        Phase::Precalibration => {
            precalibration::show(ui, model, &mut panels.precalibration, outbox);
        }
        Phase::Modeling => modeling::show(ui, model, &mut panels.modeling, outbox),
        Phase::Measuring => measuring::show(ui, model, &mut panels.measuring, outbox),
        Phase::Identification => {
            identification::show(ui, model, &mut panels.identification, outbox);
        }
        Phase::Adjustment => adjustment::show(ui, model, &mut panels.adjustment, outbox),
    });
}
