//! Panel of the phase Modeling: description of the robot with its tolerances, elongation of the cables, pulleys,
//! composition of the lengths.

pub(crate) mod cable_table;
pub(crate) mod description;
mod elongation;
mod lengths;
pub mod new_robot;
mod pose;
mod pulley_picture;
mod pulleys;
mod tolerances;

use egui::Ui;

use super::bench_panel::{Bench, TableInput};
use crate::model::command::Outbox;
use crate::model::phase::{PhaseStatus, Progress};
use crate::model::{Model, phase_status};
use crate::widgets::parts;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PanelPart {
    #[default]
    Elongation,
    Pulleys,
    Lengths,
    Description,
    Tolerances,
}

/// State of the panel between frames.
#[derive(Debug, Default)]
pub struct PanelState {
    pub part: PanelPart,
    elongation: TableInput,
    focused: description::cables::FocusedCell,
    identity: description::identity::Drafts,
    tolerances: tolerances::PanelState,
}

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let purpose = "The cable between drum and platform.";
    let Some(mut bench) = Bench::begin(ui, "Modeling", purpose, model, outbox) else {
        return;
    };
    let lengths = PhaseStatus::new(Progress::Done, "span, wrap, elongation, sag");
    let cables = bench.robot().cable_count();
    let description = PhaseStatus::new(
        Progress::Done,
        format!("{cables} cables, platform, instruments"),
    );
    let open = bench.open;
    let rows = [
        (
            PanelPart::Elongation,
            "Elongation",
            phase_status::elongation(open),
        ),
        (PanelPart::Pulleys, "Pulleys", phase_status::pulleys(open)),
        (PanelPart::Lengths, "Cable lengths", lengths),
        (PanelPart::Description, "Description", description),
        (
            PanelPart::Tolerances,
            "Tolerances",
            phase_status::tolerances(open),
        ),
    ];
    parts(ui, rows, &mut panel.part);
    match panel.part {
        PanelPart::Elongation => elongation::show(ui, &mut bench, &mut panel.elongation),
        PanelPart::Pulleys => pulleys::show(ui, &mut bench),
        PanelPart::Lengths => lengths::show(ui, &mut bench),
        PanelPart::Description => {
            description::show(ui, &mut bench, &mut panel.focused, &mut panel.identity);
        }
        PanelPart::Tolerances => tolerances::show(ui, &mut bench, &mut panel.tolerances),
    }
}
