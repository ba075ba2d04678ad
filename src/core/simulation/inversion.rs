//! Readings at which the residuals of a model vanish: the inverse of the prediction.

use crate::effect::{BetterKnown, PoseContexts};
use crate::estimation::{EstimationError, Globals, Method, Problem, RowResidual, residuals_in};
use crate::geometry::{Pose, Twist};
use crate::measurement::{Dataset, Grid};
use crate::robot::ForceSensor;

/// Largest number of fixed-point steps that invert the models of winch, force sensor and laser.
const MAX_STEPS: usize = 300;
/// Largest change of a reading at convergence (m, N, rad).
const READING_TOLERANCE: f64 = 1e-13;

/// Finds the readings for which the true model predicts the true poses and tensions (N) exactly, for cables that
/// travelled in the given directions.
pub(super) fn invert(
    exact: &mut Dataset,
    (poses, tensions): (&[Pose], &Grid),
    directions: &Grid,
) -> Result<(), EstimationError> {
    invert_within(MAX_STEPS, exact, (poses, tensions), directions)
}

/// [`invert`] with another largest number of steps.
pub(super) fn invert_within(
    most: usize,
    exact: &mut Dataset,
    (poses, tensions): (&[Pose], &Grid),
    directions: &Grid,
) -> Result<(), EstimationError> {
    if !exact.measurements.force_n.is_empty() || !exact.robot.has_tensions() {
        return invert_read(most, exact, (poses, tensions), directions);
    }
    // Tensions that no sensor of the robot reads stretch its cables all the same.
    let sensors: Vec<_> = (exact.robot.cables.iter_mut())
        .map(|cable| cable.force_sensor.replace(ForceSensor::OF_TENSION))
        .collect();
    exact.measurements.force_n = tensions.clone();
    let inverted = invert_read(most, exact, (poses, tensions), directions);
    exact.measurements.force_n = Grid::default();
    for (cable, sensor) in exact.robot.cables.iter_mut().zip(sensors) {
        cable.force_sensor = sensor;
    }
    inverted
}

fn invert_read(
    most: usize,
    exact: &mut Dataset,
    (poses, tensions): (&[Pose], &Grid),
    directions: &Grid,
) -> Result<(), EstimationError> {
    let rows: Vec<usize> = (0..poses.len()).collect();
    for _ in 0..most {
        let residuals = {
            let problem = Problem::new(exact)?.with_method(Method::Simple);
            let (robot, data) = (&exact.robot, &exact.measurements);
            let home = problem.home_row();
            let truth = BetterKnown {
                directions: Some(directions),
                tensions_n: Some(tensions),
            };
            let known = PoseContexts::new(robot, data, home, poses, truth);
            let globals = Globals::nominal(&problem);
            residuals_in(Some(known.into()), &problem, &globals, (&rows, poses))
        };
        let home = exact.robot.home.and(exact.measurements.home_row());
        let mut largest = 0.0_f64;
        for (row, residual) in residuals.iter().enumerate() {
            let tensions = tensions.row(row);
            let changes = correct(exact, row, residual, tensions, Some(row) == home);
            largest = largest.max(changes);
        }
        if largest < READING_TOLERANCE {
            break;
        }
    }
    Ok(())
}

/// Corrects the readings of a row and returns the largest change (m, N, rad).
fn correct(
    exact: &mut Dataset,
    row: usize,
    residual: &RowResidual,
    tensions: &[f64],
    is_home: bool,
) -> f64 {
    let data = &mut exact.measurements;
    let mut largest = 0.0_f64;
    let mut changed = |step: f64| largest = largest.max(step.abs());
    for (index, cable) in exact.robot.cables.iter().enumerate() {
        let add = |grid: &mut Grid, step: f64| grid.set(row, index, grid.get(row, index) + step);
        if !data.revolutions.is_empty() && !is_home {
            changed(residual.length_m[index]);
            let step = residual.length_m[index] / cable.winch.cable_per_revolution_m();
            add(&mut data.revolutions, step);
        }
        if !data.length_m.is_empty() {
            changed(residual.length_m[index]);
            add(&mut data.length_m, residual.length_m[index]);
        }
        if let (Some(sensor), false) = (cable.force_sensor, data.force_n.is_empty()) {
            let step = sensor.tension_gain * (tensions[index] - residual.tension_n[index]);
            changed(step * 1e-3);
            add(&mut data.force_n, step);
        }
        if !data.swivel_rad.is_empty() {
            changed(residual.swivel_rad[index]);
            add(&mut data.swivel_rad, residual.swivel_rad[index]);
        }
    }
    if let Some(laser) = data.laser_m.get_mut(row) {
        changed(residual.laser_m);
        *laser += residual.laser_m;
    }
    if let Some(angles) = data.inclination_rad.get_mut(row) {
        for k in 0..3 {
            changed(residual.inclination_rad[k]);
            angles[k] += residual.inclination_rad[k];
        }
    }
    if let Some(position) = data.tracked_position_m.get_mut(row) {
        for k in 0..3 {
            changed(residual.tracked_m[k]);
            position[k] += residual.tracked_m[k];
        }
    }
    if let Some(q) = data.tracked_orientation_wxyz.get_mut(row) {
        let [x, y, z] = residual.tracked_rotation_rad;
        changed(x.abs().max(y.abs()).max(z.abs()));
        *q = Pose::from_parts([0.0; 3], *q)
            .perturbed(&Twist::new(0.0, 0.0, 0.0, x, y, z))
            .orientation_wxyz();
    }
    largest
}
