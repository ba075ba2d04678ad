//! The panel of the phase Pre-calibration: winches, force sensors, home platform.

mod force_sensors;
mod home;
mod home_picture;
mod pairs;
mod winches;

use std::sync::Arc;

use egui::Ui;

use self::force_sensors::ForceSensors;
use self::winches::Winches;
use super::desk::Desk;
use crate::model::phase_status;
use crate::shell::State;
use crate::widgets::{heading, muted, parts};

/// Part of the phase.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Part {
    /// Cable per revolution.
    #[default]
    Winches,
    /// Gain and bias.
    ForceSensors,
    /// Home pose.
    Home,
}

/// What is typed for a part.
#[derive(Debug, Default)]
pub struct Typed {
    /// Path of its table.
    pub path: String,
    /// Rows to add.
    pub rows: String,
}

/// What the panel remembers.
#[derive(Debug, Default)]
pub struct PanelState {
    /// The part that is shown.
    pub part: Part,
    winches: Typed,
    force_sensors: Typed,
    home: Typed,
}

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &mut State) {
    heading(ui, "Pre-calibration");
    let Some(open) = &state.model.open else {
        return;
    };
    let calibration = Arc::clone(open.calibration());
    muted(ui, "Parts without a table keep the values of the drawing.");
    let remembered = &mut state.panels.precalibration;
    let rows = [
        (
            Part::Winches,
            "Winches",
            phase_status::winches(&calibration),
        ),
        (
            Part::ForceSensors,
            "Force sensors",
            phase_status::force_sensors(&calibration),
        ),
        (
            Part::Home,
            "Home platform",
            phase_status::home(&calibration),
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
        Part::Winches => pairs::show::<Winches>(ui, &mut desk, &mut remembered.winches),
        Part::ForceSensors => {
            pairs::show::<ForceSensors>(ui, &mut desk, &mut remembered.force_sensors);
        }
        Part::Home => home::show(ui, &mut desk, &mut remembered.home),
    }
}
