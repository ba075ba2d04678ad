//! The panel of the phase Modeling: elongation of the cables, pulleys, where their length goes.

mod elongation;
mod lengths;
mod pose;
mod pulley_picture;
mod pulleys;

use std::sync::Arc;

use egui::Ui;

use super::desk::Desk;
use super::precalibration::Typed;
use crate::model::phase::{PhaseStatus, Progress};
use crate::model::phase_status;
use crate::shell::State;
use crate::widgets::{heading, muted, parts};

/// Part of the phase.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Part {
    #[default]
    Elongation,
    Pulleys,
    Lengths,
}

/// What the panel remembers.
#[derive(Debug, Default)]
pub struct PanelState {
    part: Part,
    elongation: Typed,
}

impl PanelState {
    /// Opens the part about elongation.
    pub fn show_elongation(&mut self) {
        self.part = Part::Elongation;
    }
}

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &mut State) {
    heading(ui, "Modeling");
    let Some(open) = &state.model.open else {
        return;
    };
    let calibration = Arc::clone(open.calibration());
    muted(ui, "What happens to a cable between drum and platform.");
    let remembered = &mut state.panels.modeling;
    let rows = [
        (
            Part::Elongation,
            "Elongation",
            phase_status::elongation(open),
        ),
        (Part::Pulleys, "Pulleys", phase_status::pulleys(open)),
        (
            Part::Lengths,
            "Cable lengths",
            PhaseStatus::new(Progress::Done, "span, wrap, elongation, sag"),
        ),
    ];
    parts(ui, rows, &mut remembered.part);
    let mut desk = Desk {
        open,
        calibration: &calibration,
        selection: state.model.selection,
        outbox: &mut state.outbox,
        messages: &mut state.model.messages,
    };
    match remembered.part {
        Part::Elongation => elongation::show(ui, &mut desk, &mut remembered.elongation),
        Part::Pulleys => pulleys::show(ui, &mut desk),
        Part::Lengths => lengths::show(ui, &mut desk),
    }
}
