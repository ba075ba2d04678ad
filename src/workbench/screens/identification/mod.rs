//! The panel of the phase Identification: the geometry, and what the model still lacks.

mod ambiguous;
mod card;
mod check;
mod discrepancy;
mod doctor;
mod effects;
mod gain;
mod identify;
mod patterns;
mod results;
mod rows;
mod suspects;

use egui::Ui;

use crate::model::command::Outbox;
use crate::model::fit_progress::IdentificationState;
use crate::model::open_session::Stored;
use crate::model::tasks::Tasks;
use crate::model::{Memo, Model, OpenSession, Selection};
use crate::widgets::{Verdict, heading, muted, verdict};
use tautline_workflow::readiness::CheckItem;

/// The two halves of the panel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Half {
    /// Method and geometry.
    #[default]
    Geometry,
    /// What the model gets wrong.
    Doctor,
}

/// State of the panel between frames.
#[derive(Debug, Default)]
pub struct PanelState {
    pub half: Half,
    /// Whether the table shows every coordinate.
    show_axes: bool,
    pub open: Option<usize>,
    /// Whether it is said in full what the data cannot show.
    show_invisible: bool,
    /// Causes of the diagnosis that the session keeps from before, by document and number of results.
    stored: Memo<(u64, usize), Vec<String>>,
    /// The parts of the check that take no time, by document and its revision.
    readings: Memo<(u64, u64), Vec<CheckItem>>,
    /// Whether the matrix of faults is shown.
    shows_faults: bool,
}

/// What the parts of the panel see and change.
struct Panel<'a> {
    open: &'a OpenSession,
    tasks: &'a Tasks,
    /// What accompanies the identification.
    run: &'a IdentificationState,
    selection: Selection,
    outbox: &'a mut Outbox,
    memory: &'a mut PanelState,
}

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    heading(ui, "Identification");
    let Some(open) = &model.open else {
        return;
    };
    let poses = open.session().measurements.len();
    if poses == 0 {
        muted(
            ui,
            "Pulley positions and a diagnosis of the model appear here once poses are measured. Measure in phase 3, or open a dataset folder.",
        );
        return;
    }
    let panel = &mut Panel {
        open,
        tasks: &model.tasks,
        run: &model.identification,
        selection: model.selection,
        outbox,
        memory: panel,
    };
    ui.horizontal(|ui| {
        let halves = [(Half::Geometry, "Geometry"), (Half::Doctor, "Model doctor")];
        for (half, name) in halves {
            ui.selectable_value(&mut panel.memory.half, half, name);
        }
    });
    match panel.memory.half {
        Half::Geometry => geometry(ui, panel),
        Half::Doctor => doctor::show(ui, panel),
    }
}

fn geometry(ui: &mut Ui, panel: &mut Panel<'_>) {
    muted(
        ui,
        "Estimates the pulley positions from the measured poses.",
    );
    if panel.open.stored() == Stored::OutOfDate {
        verdict(
            ui,
            Verdict::Doubtful,
            "The result in this session belongs to other data: identify again.",
        );
    }
    check::show(ui, panel);
    identify::show(ui, panel);
    results::show(ui, panel);
}
