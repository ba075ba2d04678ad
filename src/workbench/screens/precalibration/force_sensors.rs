//! Force sensors: gain and bias.

use egui::Ui;
use tautline_core::instrument::{FORCE_RESIDUAL_LIMIT_N, ForceSensorCalibration};
use tautline_session::{ForcePair, PhaseData};

use super::pairs::{ByPairs, Pair, Quality, Words};
use crate::screens::desk::{Desk, decimals_for, or_dash};
use crate::widgets::{Cell, Column, Numbers, RowField, section, table};
use tautline_workflow::precalibration::{Calibration, PerCable, Table};

const FIELDS: [RowField; 2] = [
    RowField {
        title: "Reading",
        unit: "N",
        per_si: 1.0,
        decimals: 3,
        optional: false,
        accepts: f64::is_finite,
        expects: "a number",
    },
    RowField {
        title: "Load",
        unit: "N",
        per_si: 1.0,
        decimals: 3,
        optional: false,
        accepts: |value| value >= 0.0,
        expects: "a load of 0 or more",
    },
];

/// The force sensors.
pub struct ForceSensors;

impl ByPairs for ForceSensors {
    type Pair = ForcePair;
    type Fit = ForceSensorCalibration;

    const WORDS: Words = Words {
        table: Table::Force,
        one: "Sensor",
        several: "force sensors",
        instruction: "Residuals and verdicts appear here. Hang known weights on a cable, note what its force sensor reads, and import the pairs or type them below. At least three pairs of a sensor are needed.",
        advice: "Look for a wrong pair, a cable that rubs, or a sensor that is overloaded.",
        along: ("Load", "N"),
        fields: &FIELDS,
        unit: ("N", 1.0),
        limit: FORCE_RESIDUAL_LIMIT_N,
        decimals: 2,
    };

    fn fits(calibration: &Calibration) -> &[PerCable<ForceSensorCalibration>] {
        &calibration.force_sensors
    }

    fn quality(fit: &ForceSensorCalibration) -> Quality<'_> {
        Quality {
            passed: fit.passed,
            spread: fit.residual_sd_n,
            largest: fit.largest_residual_n,
            residuals: &fit.residuals_n,
        }
    }

    fn pairs(phases: &PhaseData) -> &[ForcePair] {
        &phases.force
    }

    fn pairs_mut(phases: &mut PhaseData) -> &mut Vec<ForcePair> {
        &mut phases.force
    }

    fn place(pair: &ForcePair) -> f64 {
        pair.load_n
    }

    fn values(ui: &mut Ui, desk: &mut Desk<'_>) {
        values(ui, desk);
    }
}

impl Pair for ForcePair {
    fn cable(&self) -> usize {
        self.cable
    }

    fn numbers(&self) -> Numbers {
        [Some(self.reading_n), Some(self.load_n), None]
    }

    fn of(cable: usize, [reading_n, load_n, _]: Numbers) -> Option<Self> {
        Some(Self {
            cable,
            reading_n: reading_n?,
            load_n: load_n?,
        })
    }
}

fn values(ui: &mut Ui, desk: &mut Desk<'_>) {
    section(ui, "Reading for each newton, and without load");
    let columns = [
        Column::words("Sensor"),
        Column::number("Gain now", ""),
        Column::number("Measured", ""),
        Column::number("±", ""),
        Column::number("Bias now", "N"),
        Column::number("Measured", "N"),
        Column::number("±", "N"),
    ];
    let calibration = desk.calibration;
    let rows: Vec<Vec<Cell>> = calibration
        .force_sensors
        .iter()
        .filter_map(|PerCable { cable, fit }| {
            let fit = fit.as_ref().ok()?;
            let now = desk.robot().cables.get(*cable)?.force_sensor;
            let gain = decimals_for(fit.gain_sd, 2, 3);
            let bias = decimals_for(fit.bias_sd_n, 1, 2);
            Some(vec![
                desk.cable_cell(ui, *cable),
                or_dash(now.map(|sensor| sensor.tension_gain), gain),
                Cell::new(format!("{:.gain$}", fit.gain)),
                Cell::new(format!("{:.gain$}", fit.gain_sd)),
                or_dash(now.map(|sensor| sensor.bias_n), bias),
                Cell::new(format!("{:.bias$}", fit.bias_n)),
                Cell::new(format!("{:.bias$}", fit.bias_sd_n)),
            ])
        })
        .collect();
    table(ui, &columns, &rows, None);
    let proposal = &calibration.with_force_sensors;
    let what = "use measured force sensors";
    desk.propose(ui, proposal, "Use these values", what);
}
