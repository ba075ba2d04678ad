//! The robot as effects make it at one pose: what holds the platform there.

use crate::effect::{BoundEffect, Circumstances, Dual, PlatformPorts};
use crate::geometry::Pose;
use crate::measurement::Measurements;
use crate::robot::Robot;

/// Pauses between poses (s).
const SECONDS_PER_POSE: f64 = 30.0;

/// Label, time and temperature of the rows of a simulated run.
pub(super) struct Schedule {
    pub labels: Vec<i64>,
    pub time_s: Vec<f64>,
    pub temperature_c: Vec<f64>,
}

impl Schedule {
    /// Up to and including a row.
    pub fn of(robot: &Robot, last: usize) -> Self {
        let first = i64::from(robot.home.is_none());
        Self::at((first..).take(last + 1).collect())
    }

    /// Poses with these labels, the time following them.
    pub fn at(labels: Vec<i64>) -> Self {
        let first = labels.first().copied().unwrap_or_default();
        let time_s: Vec<f64> = labels
            .iter()
            .map(|label| SECONDS_PER_POSE * (label - first) as f64)
            .collect();
        Self {
            labels,
            temperature_c: time_s
                .iter()
                .map(|t| 20.0 + 2.0 * (t / 3600.0).sin())
                .collect(),
            time_s,
        }
    }
}

/// The robot with what effects change of its geometry and weight at the last row of `schedule`, at `pose`
/// under `tensions` (N). Earlier poses are those visited.
pub(super) fn loaded_robot(
    truth: &Robot,
    effects: &[BoundEffect],
    schedule: &Schedule,
    (visited, pose): (&[Pose], &Pose),
    tensions: &[f64],
) -> Robot {
    // The first row tells time and temperature from which all others count.
    let rows: Vec<usize> = if visited.is_empty() {
        vec![0]
    } else {
        vec![0, visited.len()]
    };
    let poses: Vec<Pose> = visited.first().into_iter().chain([pose]).copied().collect();
    let data = Measurements {
        labels: rows.iter().map(|row| schedule.labels[*row]).collect(),
        time_s: rows.iter().map(|row| schedule.time_s[*row]).collect(),
        temperature_c: rows
            .iter()
            .map(|row| schedule.temperature_c[*row])
            .collect(),
        ..Measurements::default()
    };
    let home = truth.home.map(|_| 0);
    let circumstances = Circumstances::new(truth, &data, home, &poses, None);
    let row = rows.len() - 1;
    let mut robot = truth.clone();
    let constants = |values: &[f64]| -> Vec<Dual> {
        values.iter().map(|value| Dual::constant(*value)).collect()
    };
    let mut platform = PlatformPorts::nominal(truth);
    let ports = circumstances.cable_ports(row, truth, effects, tensions);
    for (cable, ports) in robot.cables.iter_mut().zip(ports) {
        ports.change_geometry(cable);
    }
    for bound in effects {
        let values = constants(&bound.values);
        let at = circumstances.platform(row);
        bound.effect.change_platform(&values, at, &mut platform);
    }
    robot.platform.mass_kg = truth.platform.mass_kg.map(|_| platform.mass.value);
    robot.platform.center_of_mass_m = platform.center_of_mass.map(|dual| dual.value);
    robot
}
