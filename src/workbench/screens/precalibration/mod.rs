//! Panel of the phase Pre-calibration: winches, force sensors, home platform.

mod force_sensors;
mod home;
mod home_picture;
mod home_poses;
mod pairs;
mod winches;

use egui::Ui;

use self::force_sensors::ForceSensors;
use self::home::HomeInput;
use self::winches::Winches;
use super::bench_panel::{Bench, TableInput};
use crate::model::command::Outbox;
use crate::model::{Model, phase_status};
use crate::widgets::parts;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PanelPart {
    /// Cable per revolution.
    #[default]
    Winches,
    /// Gain and bias.
    ForceSensors,
    Home,
}

/// State of the panel between frames.
#[derive(Debug, Default)]
pub struct PanelState {
    pub part: PanelPart,
    winches: TableInput,
    force_sensors: TableInput,
    home: HomeInput,
}

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let purpose = "Without measurements, nominal values are used.";
    let Some(mut bench) = Bench::begin(ui, "Pre-calibration", purpose, model, outbox) else {
        return;
    };
    let of = bench.calibration;
    let rows = [
        (PanelPart::Winches, "Winches", phase_status::winches(of)),
        (
            PanelPart::ForceSensors,
            "Force sensors",
            phase_status::force_sensors(of),
        ),
        (PanelPart::Home, "Home platform", phase_status::home(of)),
    ];
    parts(ui, rows, &mut panel.part);
    match panel.part {
        PanelPart::Winches => pairs::show::<Winches>(ui, &mut bench, &mut panel.winches),
        PanelPart::ForceSensors => {
            pairs::show::<ForceSensors>(ui, &mut bench, &mut panel.force_sensors);
        }
        PanelPart::Home => home::show(ui, &mut bench, &mut panel.home),
    }
}
