//! Panel of the phase Identification: the geometry, and the diagnosis of the model.

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
use crate::model::open_session::StoredFit;
use crate::model::{Model, OpenSession};
use crate::widgets::UiExt;

/// Tabs of the panel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum IdentificationTab {
    /// Method and geometry.
    #[default]
    Geometry,
    /// Diagnosis of the model.
    Doctor,
}

/// State of the panel between frames.
#[derive(Debug, Default)]
pub struct PanelState {
    pub tab: IdentificationTab,
    /// Whether the table shows all coordinates.
    show_axes: bool,
    /// Whether the faults that the data cannot show are listed in full.
    show_invisible: bool,
    /// Whether the matrix of faults is open.
    shows_faults: bool,
}

/// Context of the parts of the panel.
struct Panel<'a> {
    model: &'a Model,
    open: &'a OpenSession,
    outbox: &'a mut Outbox,
    memory: &'a mut PanelState,
}

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.heading("Identification");
    let Some(open) = &model.open else {
        return;
    };
    let poses = open.session().measurements.len();
    if poses == 0 {
        ui.muted("Pulley positions and a diagnosis of the model appear here once poses are measured. Measure in phase 3, or open a dataset folder.");
        return;
    }
    let panel = &mut Panel {
        model,
        open,
        outbox,
        memory: panel,
    };
    ui.horizontal(|ui| {
        let tabs = [
            (IdentificationTab::Geometry, "Geometry"),
            (IdentificationTab::Doctor, "Model doctor"),
        ];
        for (tab, name) in tabs {
            ui.selectable_value(&mut panel.memory.tab, tab, name);
        }
    });
    match panel.memory.tab {
        IdentificationTab::Geometry => geometry(ui, panel),
        IdentificationTab::Doctor => doctor::show(ui, panel),
    }
}

fn geometry(ui: &mut Ui, panel: &mut Panel<'_>) {
    ui.muted("Estimates the pulley positions from the measured poses.");
    if panel.open.stored() == StoredFit::OutOfDate {
        ui.doubtful("The result in this session belongs to other data: identify again.");
    }
    check::show(ui, panel);
    identify::show(ui, panel);
    results::show(ui, panel);
}
