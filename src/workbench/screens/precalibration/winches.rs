//! Winches: cable per motor revolution.

use egui::Ui;
use tautline_core::instrument::{WINCH_RESIDUAL_LIMIT_M, WinchCalibration};
use tautline_session::{PhaseData, WinchPair};

use super::pairs::{ByPairs, Pair, Quality, Words};
use crate::screens::desk::{Desk, decimals_for};
use crate::widgets::{Cell, Column, Numbers, RowField, section, table};
use tautline_workflow::precalibration::{Calibration, PerCable, Table};

const FIELDS: [RowField; 3] = [
    RowField {
        title: "Revolutions",
        unit: "",
        per_si: 1.0,
        decimals: 4,
        optional: false,
        accepts: f64::is_finite,
        expects: "a number",
    },
    RowField {
        title: "Length",
        unit: "mm",
        per_si: 1e3,
        decimals: 3,
        optional: false,
        accepts: |value| value.abs() <= 1e3,
        expects: "at most 1 km",
    },
    RowField {
        title: "Tension",
        unit: "N",
        per_si: 1.0,
        decimals: 1,
        optional: true,
        accepts: f64::is_finite,
        expects: "a number",
    },
];

/// The winches.
pub struct Winches;

impl ByPairs for Winches {
    type Pair = WinchPair;
    type Fit = WinchCalibration;

    const WORDS: Words = Words {
        table: Table::Winch,
        one: "Winch",
        several: "winches",
        instruction: "Residuals and verdicts appear here. Turn a winch by known revolutions, measure how much cable it pays out, and import the pairs or type them below. At least three pairs of a winch are needed.",
        advice: "Look for a wrong pair, backlash or a drum that is not round.",
        along: ("Revolutions", ""),
        fields: &FIELDS,
        unit: ("mm", 1e3),
        limit: WINCH_RESIDUAL_LIMIT_M * 1e3,
        decimals: 3,
    };

    fn fits(calibration: &Calibration) -> &[PerCable<WinchCalibration>] {
        &calibration.winches
    }

    fn quality(fit: &WinchCalibration) -> Quality<'_> {
        Quality {
            passed: fit.passed,
            spread: fit.residual_sd_m * 1e3,
            largest: fit.largest_residual_m * 1e3,
            residuals: &fit.residuals_m,
        }
    }

    fn pairs(phases: &PhaseData) -> &[WinchPair] {
        &phases.winch
    }

    fn pairs_mut(phases: &mut PhaseData) -> &mut Vec<WinchPair> {
        &mut phases.winch
    }

    fn place(pair: &WinchPair) -> f64 {
        pair.revolutions
    }

    fn values(ui: &mut Ui, desk: &mut Desk<'_>) {
        values(ui, desk);
    }
}

impl Pair for WinchPair {
    fn cable(&self) -> usize {
        self.cable
    }

    fn numbers(&self) -> Numbers {
        [Some(self.revolutions), Some(self.length_m), self.tension_n]
    }

    fn of(cable: usize, [revolutions, length_m, tension_n]: Numbers) -> Option<Self> {
        Some(Self {
            cable,
            revolutions: revolutions?,
            length_m: length_m?,
            tension_n,
        })
    }
}

fn values(ui: &mut Ui, desk: &mut Desk<'_>) {
    section(ui, "Cable per motor revolution");
    let columns = [
        Column::words("Winch"),
        Column::number("In the robot", "mm"),
        Column::number("Measured", "mm"),
        Column::number("±", "mm"),
        Column::number("Change", "mm"),
    ];
    let calibration = desk.calibration;
    let rows: Vec<Vec<Cell>> = calibration
        .winches
        .iter()
        .filter_map(|PerCable { cable, fit }| {
            let fit = fit.as_ref().ok()?;
            let winch = &desk.robot().cables.get(*cable)?.winch;
            let old = winch.cable_per_revolution_m() * 1e3;
            let new = fit.cable_per_revolution_m * 1e3;
            let sd = fit.cable_per_revolution_sd_m * 1e3;
            let digits = decimals_for(sd, 2, 4);
            Some(vec![
                desk.cable_cell(ui, *cable),
                Cell::new(format!("{old:.digits$}")),
                Cell::new(format!("{new:.digits$}")),
                Cell::new(format!("{sd:.digits$}")),
                Cell::new(format!("{:+.digits$}", new - old)),
            ])
        })
        .collect();
    table(ui, &columns, &rows, None);
    let proposal = &calibration.with_winches;
    desk.propose(ui, proposal, "Use these values", "use measured winches");
}
