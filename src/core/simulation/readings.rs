//! What the instruments of a virtual robot read: the prediction inverted, then noise.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::SimulationError;
use super::loaded::Schedule;
use crate::effect::{Circumstances, sign};
use crate::estimation::{Globals, Method, Problem, RowResidual, residuals_under};
use crate::geometry::{Pose, Twist};
use crate::kinematics::inverse_kinematics;
use crate::measurement::{Dataset, Grid, Measurements, Truth};
use crate::robot::Robot;

/// Least and most steps that invert the models of winch, force sensor and laser.
const INVERSION_STEPS: [usize; 2] = [12, 300];
/// The same where nobody compares the last digits.
const PLANNING_STEPS: [usize; 2] = [2, 30];
/// Readings that change by less than this (m, N, rad) are final.
const SETTLED_READING: f64 = 1e-13;

pub(super) fn normal(rng: &mut ChaCha8Rng, sd: f64) -> f64 {
    sd * rng.sample::<f64, _>(StandardNormal)
}

/// When a pose is measured that is only planned, and how the cables hold it.
pub(crate) struct PlannedRow {
    /// Label of the pose; times follow from labels.
    pub label: i64,
    /// Where.
    pub pose: Pose,
    /// Tensions (N).
    pub tensions_n: Vec<f64>,
}

/// Readings without noise when the platform is exactly at these poses of a robot that is exactly as described;
/// the home pose is the first if there is one.
///
/// # Errors
/// If the kinematics has no answer at one of them.
pub(crate) fn planned_readings(
    robot: &Robot,
    rows: &[PlannedRow],
) -> Result<Measurements, SimulationError> {
    let poses: Vec<Pose> = rows.iter().map(|row| row.pose).collect();
    let mut tensions = Grid::new(robot.cable_count());
    rows.iter()
        .for_each(|row| tensions.push_row(&row.tensions_n));
    let schedule = Schedule::at(rows.iter().map(|row| row.label).collect());
    let mut exact = Dataset {
        robot: robot.clone(),
        measurements: blank(robot, schedule, (&poses, &poses), &tensions),
    };
    invert_in(PLANNING_STEPS, &mut exact, &poses, &tensions)?;
    Ok(exact.measurements)
}

/// Rows with everything known but the readings.
pub(super) fn blank(
    robot: &Robot,
    schedule: Schedule,
    (poses, commanded): (&[Pose], &[Pose]),
    tensions: &Grid,
) -> Measurements {
    let rows = poses.len();
    let cables = robot.cable_count();
    let zeros = || {
        let mut grid = Grid::new(cables);
        (0..rows).for_each(|_| grid.push_row(&vec![0.0; cables]));
        grid
    };
    let when = |present: bool| if present { zeros() } else { Grid::default() };
    let swivels = robot
        .cables
        .iter()
        .all(|c| c.pulley.swivel_sd_rad.is_some() && c.pulley.swivel_zero.is_some());
    Measurements {
        labels: schedule.labels,
        temperature_c: schedule.temperature_c,
        time_s: schedule.time_s,
        commanded: commanded.iter().copied().map(Some).collect(),
        revolutions: when(robot.home.is_some()),
        length_m: when(robot.home.is_none()),
        force_n: nominal_forces(robot, tensions),
        laser_m: robot.laser.map_or_else(Vec::new, |_| vec![0.0; rows]),
        swivel_rad: when(swivels),
        inclination_rad: robot
            .inclinometer
            .map_or_else(Vec::new, |_| vec![[0.0; 3]; rows]),
        tracked_position_m: robot.tracker.map_or_else(Vec::new, |_| {
            poses.iter().map(|p| p.position.into()).collect()
        }),
        tracked_orientation_wxyz: match robot.tracker.and_then(|t| t.orientation_sd_rad) {
            Some(_) => poses.iter().map(Pose::orientation_wxyz).collect(),
            None => Vec::new(),
        },
        truth: Truth {
            poses: poses.to_vec(),
            tension_n: tensions.clone(),
        },
        ..Measurements::default()
    }
}

/// Raw readings at the true tensions by the nominal sensors.
fn nominal_forces(robot: &Robot, tensions: &Grid) -> Grid {
    let mut forces = Grid::default();
    if robot.has_force_sensors() && robot.platform.mass_kg.is_some() {
        forces = tensions.clone();
        for row in 0..tensions.rows() {
            for (index, cable) in robot.cables.iter().enumerate() {
                let tension = tensions.get(row, index);
                let reading = cable
                    .force_sensor
                    .map_or(f64::NAN, |s| s.reading_n(tension));
                forces.set(row, index, reading);
            }
        }
    }
    forces
}

/// Finds the readings that the true model predicts exactly.
pub(super) fn invert(
    exact: &mut Dataset,
    poses: &[Pose],
    tensions: &Grid,
) -> Result<(), SimulationError> {
    invert_in(INVERSION_STEPS, exact, poses, tensions)
}

fn invert_in(
    [least, most]: [usize; 2],
    exact: &mut Dataset,
    poses: &[Pose],
    tensions: &Grid,
) -> Result<(), SimulationError> {
    let rows: Vec<usize> = (0..poses.len()).collect();
    let directions = true_directions(&exact.robot, poses)?;
    for step in 0..most {
        let residuals = {
            let problem = Problem::new(exact)?.with_method(Method::Simple);
            let (robot, data) = (&exact.robot, &exact.measurements);
            let home = problem.home_row();
            let known = Circumstances::new(robot, data, home, poses, Some(&directions));
            let globals = Globals::nominal(&problem);
            residuals_under(Some(known.into()), &problem, &globals, (&rows, poses))
        };
        let home = exact.robot.home.and(exact.measurements.home_row());
        let mut largest = 0.0_f64;
        for (row, residual) in residuals.iter().enumerate() {
            let tensions = tensions.row(row);
            let changes = correct(exact, row, residual, tensions, Some(row) == home);
            largest = largest.max(changes);
        }
        if step + 1 >= least && largest < SETTLED_READING {
            break;
        }
    }
    Ok(())
}

/// Direction of travel of every cable to every pose: the sign of the change of its geometric length.
fn true_directions(robot: &Robot, poses: &[Pose]) -> Result<Grid, SimulationError> {
    let mut directions = Grid::new(robot.cable_count());
    let mut before: Option<Vec<f64>> = None;
    for pose in poses {
        let states = inverse_kinematics(robot, pose)?;
        let lengths: Vec<f64> = states.iter().map(|state| state.length_m).collect();
        let from = before.as_ref().unwrap_or(&lengths);
        let signs: Vec<f64> = lengths.iter().zip(from).map(|(l, f)| sign(l - f)).collect();
        directions.push_row(&signs);
        before = Some(lengths);
    }
    Ok(directions)
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
    largest
}

pub(super) fn add_noise(robot: &Robot, data: &mut Measurements, rng: &mut ChaCha8Rng) {
    let home = robot.home.and(data.home_row());
    for row in 0..data.len() {
        for (index, cable) in robot.cables.iter().enumerate() {
            let mut add = |grid: &mut Grid, sd: f64| {
                if !grid.is_empty() {
                    grid.set(row, index, grid.get(row, index) + normal(rng, sd));
                }
            };
            let sd = cable.winch.length_sd_m;
            if Some(row) != home {
                add(
                    &mut data.revolutions,
                    sd / cable.winch.cable_per_revolution_m(),
                );
            }
            add(&mut data.length_m, sd);
            if let Some(sensor) = cable.force_sensor {
                add(
                    &mut data.force_n,
                    sensor.tension_gain.abs() * sensor.tension_sd_n,
                );
            }
            add(
                &mut data.swivel_rad,
                cable.pulley.swivel_sd_rad.unwrap_or(0.0),
            );
        }
        if let (Some(laser), Some(reading)) = (&robot.laser, data.laser_m.get_mut(row)) {
            *reading += normal(rng, laser.sd_m);
        }
        if let (Some(sensor), Some(angles)) =
            (&robot.inclinometer, data.inclination_rad.get_mut(row))
        {
            for angle in angles {
                *angle += normal(rng, sensor.sd_rad);
            }
        }
        add_tracker_noise(robot, data, row, rng);
    }
}

fn add_tracker_noise(robot: &Robot, data: &mut Measurements, row: usize, rng: &mut ChaCha8Rng) {
    let Some(tracker) = &robot.tracker else {
        return;
    };
    if let Some(position) = data.tracked_position_m.get_mut(row) {
        for (value, sd) in position.iter_mut().zip(tracker.position_sd_m.each()) {
            *value += normal(rng, sd);
        }
    }
    if let (Some(sd), Some(q)) = (
        tracker.orientation_sd_rad,
        data.tracked_orientation_wxyz.get_mut(row),
    ) {
        let twist = Twist::new(
            0.0,
            0.0,
            0.0,
            normal(rng, sd),
            normal(rng, sd),
            normal(rng, sd),
        );
        *q = Pose::from_parts([0.0; 3], *q)
            .perturbed(&twist)
            .orientation_wxyz();
    }
}
