//! Force sensors: gain and bias.

use tautline_core::instrument::{FORCE_RESIDUAL_LIMIT_N, ForceSensorCalibration};
use tautline_core::robot::Cable;
use tautline_session::{ForcePair, PhaseData};

use super::pairs::{Calibrated, Fitted, InstrumentTexts, Pair, Quality};
use crate::widgets::{Numbers, RowField};
use tautline_workflow::precalibration::{Calibration, PerCable, Proposal, Table};

const FIELDS: [RowField; 2] = [
    RowField::new("Reading", "N", 3),
    RowField::new("Load", "N", 3).accepting(|value| value >= 0.0, "a load of 0 or more"),
];

pub struct ForceSensors;

impl Calibrated for ForceSensors {
    type Pair = ForcePair;
    type Fit = ForceSensorCalibration;

    const WORDS: InstrumentTexts = InstrumentTexts {
        table: Table::Force,
        one: "Sensor",
        several: "force sensors",
        instruction: "Residuals and results appear here. Load a cable with known weights, note the readings of its force sensor, and import the pairs or type them below. Each sensor needs at least three pairs.",
        advice: "Check for a wrong pair, friction of the cable or an overloaded sensor.",
        along: ("Load", "N"),
        fields: &FIELDS,
        values_title: "Gain and bias",
        values: &[("Current gain", ""), ("Current bias", "N")],
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

    fn values(fit: &ForceSensorCalibration, cable: &Cable) -> Vec<Fitted> {
        let sensor = cable.force_sensor;
        vec![
            Fitted {
                current: sensor.map(|sensor| sensor.tension_gain),
                value: fit.gain,
                sd: fit.gain_sd,
                decimals: [2, 3],
            },
            Fitted {
                current: sensor.map(|sensor| sensor.bias_n),
                value: fit.bias_n,
                sd: fit.bias_sd_n,
                decimals: [1, 2],
            },
        ]
    }

    fn proposal(calibration: &Calibration) -> &Proposal {
        &calibration.with_force_sensors
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
