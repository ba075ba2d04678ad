//! Residuals in physical units at given poses; simulation inverts the prediction behind them, and reports
//! show them.

use std::sync::Arc;

use super::evaluator::Evaluator;
use super::globals::Globals;
use super::home::HomeRow;
use super::problem::Problem;
use crate::effect::{CablePort, PoseContexts};
use crate::geometry::Pose;

/// Prediction minus reading at one row of the measurements; NaN where there is no reading.
#[derive(Debug, Clone, PartialEq)]
pub struct RowResidual {
    /// Unstrained length paid out, per cable (m).
    pub length_m: Vec<f64>,
    /// Laser distance (m).
    pub laser_m: f64,
    /// Swivel angle, per cable (rad).
    pub swivel_rad: Vec<f64>,
    /// Tension at the platform that the model derives from the reading, per cable (N).
    pub tension_n: Vec<f64>,
    /// Roll, pitch and yaw (rad).
    pub inclination_rad: [f64; 3],
    /// Position measured by the external instrument (m).
    pub tracked_m: [f64; 3],
    /// Rotation from the orientation measured by the external instrument to that of the model (rad).
    pub tracked_rotation_rad: [f64; 3],
}

/// Residuals of `rows` at `poses` for given common parameters, without estimating anything.
#[must_use]
pub fn residuals_at(
    problem: &Problem<'_>,
    globals: &Globals,
    rows: &[usize],
    poses: &[Pose],
) -> Vec<RowResidual> {
    residuals_in(None, problem, globals, (rows, poses))
}

/// As [`residuals_at`], in contexts that are known better than from the readings, as in a simulation.
pub(crate) fn residuals_in(
    contexts: Option<Arc<PoseContexts>>,
    problem: &Problem<'_>,
    globals: &Globals,
    (rows, poses): (&[usize], &[Pose]),
) -> Vec<RowResidual> {
    let home = match problem.home_row() {
        Some(row) => {
            let mut evaluator = Evaluator::<f64>::home((), problem, globals, row);
            if let Some(known) = &contexts {
                evaluator.set_contexts(Arc::clone(known));
            }
            HomeRow::evaluate(&mut evaluator, problem, globals, &[], None)
        }
        None => HomeRow::absolute(problem),
    };
    let mut evaluator = Evaluator::<f64>::new((), problem, globals, rows.to_vec(), poses);
    if let Some(known) = contexts {
        evaluator.set_contexts(known);
    }
    evaluator.set_globals(globals, Some(&home.lengths));
    (0..rows.len())
        .map(|index| row_residual(&mut evaluator, problem, index))
        .collect()
}

fn row_residual(
    evaluator: &mut Evaluator<'_, f64>,
    problem: &Problem<'_>,
    index: usize,
) -> RowResidual {
    let robot = &problem.dataset.robot;
    let layout = evaluator.layout.clone();
    let tension_n = (0..layout.cables)
        .map(|c| evaluator.cable_port(index, c, CablePort::Tension))
        .collect();
    let equations = evaluator.equations_at(index);
    let raw = |row: usize, sd: f64| {
        if equations.present[row] > 0.0 {
            equations.residual[row] * sd
        } else {
            f64::NAN
        }
    };
    // A length row is whitened by `-dr/ds`, whatever part of its variance the tension has.
    let length_m = (0..layout.cables)
        .map(|cable| raw(cable, -equations.length_by_cable[cable][3].recip()))
        .collect();
    let swivel_sd = |cable: usize| robot.cables[cable].pulley.swivel_sd_rad.unwrap_or(f64::NAN);
    let laser_sd = robot.laser.map_or(f64::NAN, |laser| laser.sd_m);
    let inclination_sd = robot.inclinometer.map_or(f64::NAN, |sensor| sensor.sd_rad);
    let inclination = |k: usize| {
        layout
            .inclination
            .map_or(f64::NAN, |first| raw(first + k, inclination_sd))
    };
    // A position row is whitened by its derivative along the axis, as poses may have standard deviations of their own.
    let position = |k: usize| {
        let row = layout.tracker_position.map(|first| first + k);
        row.map_or(f64::NAN, |row| raw(row, equations.by_pose[row][k].recip()))
    };
    let rotation_sd = robot.tracker.and_then(|tracker| tracker.orientation_sd_rad);
    let rotation = |k: usize| {
        let row = layout.tracker_orientation.map(|first| first + k);
        row.map_or(f64::NAN, |row| raw(row, rotation_sd.unwrap_or(f64::NAN)))
    };
    RowResidual {
        length_m,
        laser_m: layout.laser.map_or(f64::NAN, |row| raw(row, laser_sd)),
        swivel_rad: match layout.swivel {
            Some(first) => (0..layout.cables)
                .map(|c| raw(first + c, swivel_sd(c)))
                .collect(),
            None => Vec::new(),
        },
        tension_n,
        inclination_rad: std::array::from_fn(inclination),
        tracked_m: std::array::from_fn(position),
        tracked_rotation_rad: std::array::from_fn(rotation),
    }
}
