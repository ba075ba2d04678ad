//! The screens: a panel for each phase, the start screen, the comparison.

pub mod adjustment;
pub mod compare;
pub mod connect;
mod desk;
pub mod identification;
pub mod measuring;
pub mod modeling;
pub mod precalibration;
pub mod start;

use egui::{ScrollArea, Ui};

use crate::app::State;
use crate::app::screen::Step;

/// What the screens remember.
#[derive(Debug, Default)]
pub struct Screens {
    /// Of the start screen.
    pub start: start::Remembered,
    /// Of the phase Measuring.
    pub measuring: measuring::Remembered,
    /// Of the phase Adjustment.
    pub adjustment: adjustment::Remembered,
    /// Of the phase Identification.
    pub identification: identification::Remembered,
    /// Of phase 1.
    pub precalibration: precalibration::Remembered,
    /// Of phase 2.
    pub modeling: modeling::Remembered,
    /// Of the window that connects, while it is open.
    pub connect: Option<Box<connect::Draft>>,
    /// Of the comparison.
    pub compare: compare::Remembered,
}

/// Draws the panel of a phase.
pub fn phase(ui: &mut Ui, state: &mut State, step: Step) {
    ScrollArea::vertical()
        .id_salt(step)
        .auto_shrink(false)
        .show(ui, |ui| match step {
            Step::Precalibration => precalibration::show(ui, state),
            Step::Modeling => modeling::show(ui, state),
            Step::Measuring => measuring::show(ui, state),
            Step::Identification => identification::show(ui, state),
            Step::Adjustment => adjustment::show(ui, state),
        });
}
