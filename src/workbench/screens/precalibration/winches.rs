//! Winches: cable per motor revolution.

use tautline_core::instrument::{WINCH_RESIDUAL_LIMIT_M, WinchCalibration};
use tautline_core::robot::Cable;
use tautline_session::{PhaseData, WinchPair};

use super::pairs::{Calibrated, Fitted, InstrumentTexts, Pair, Quality};
use crate::widgets::{Numbers, RowField};
use tautline_workflow::precalibration::{Calibration, PerCable, Proposal, Table};

const FIELDS: [RowField; 3] = [
    RowField::new("Revolutions", "", 4),
    RowField::millimetres("Length", 3).accepting(|value| value.abs() <= 1e3, "at most 1 km"),
    RowField::new("Tension", "N", 1).optional(),
];

pub struct Winches;

impl Calibrated for Winches {
    type Pair = WinchPair;
    type Fit = WinchCalibration;

    const WORDS: InstrumentTexts = InstrumentTexts {
        table: Table::Winch,
        one: "Winch",
        several: "winches",
        instruction: "Residuals and results appear here. Turn a winch by known revolutions, measure how much cable it pays out, and import the pairs or type them below. Each winch needs at least three pairs.",
        advice: "Check for a wrong pair, backlash or an eccentric drum.",
        along: ("Revolutions", ""),
        fields: &FIELDS,
        values_title: "Cable per motor revolution",
        values: &[("Current", "mm")],
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

    fn values(fit: &WinchCalibration, cable: &Cable) -> Vec<Fitted> {
        vec![Fitted {
            current: Some(cable.winch.cable_per_revolution_m() * 1e3),
            value: fit.cable_per_revolution_m * 1e3,
            sd: fit.cable_per_revolution_sd_m * 1e3,
            decimals: [2, 4],
        }]
    }

    fn proposal(calibration: &Calibration) -> &Proposal {
        &calibration.with_winches
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
