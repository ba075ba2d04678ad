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
use crate::app::State;
use crate::app::screen::{Progress, Standing};
use crate::app::standing;
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
pub struct Remembered {
    part: Part,
    elongation: Typed,
}

impl Remembered {
    /// Opens the part about elongation.
    pub fn show_elongation(&mut self) {
        self.part = Part::Elongation;
    }
}

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &mut State) {
    heading(ui, "Modeling");
    let Some(document) = &state.document else {
        return;
    };
    let calibration = Arc::clone(document.calibration());
    muted(ui, "What happens to a cable between drum and platform.");
    let remembered = &mut state.screens.modeling;
    let rows = [
        (
            Part::Elongation,
            "Elongation",
            standing::elongation(document),
        ),
        (Part::Pulleys, "Pulleys", standing::pulleys(document)),
        (
            Part::Lengths,
            "Cable lengths",
            Standing::new(Progress::Done, "span, wrap, elongation, sag"),
        ),
    ];
    parts(ui, rows, &mut remembered.part);
    let mut desk = Desk {
        document,
        calibration: &calibration,
        selection: state.selection,
        outbox: &mut state.outbox,
        messages: &mut state.messages,
    };
    match remembered.part {
        Part::Elongation => elongation::show(ui, &mut desk, &mut remembered.elongation),
        Part::Pulleys => pulleys::show(ui, &mut desk),
        Part::Lengths => lengths::show(ui, &mut desk),
    }
}
