//! Readings of the instruments of a virtual robot: the inverted prediction plus noise.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::SimulationError;
use super::holding_tensions::Schedule;
use super::inversion::invert_within;
use crate::effect::sign;
use crate::geometry::{Pose, Twist};
use crate::kinematics::inverse_kinematics;
use crate::measurement::{Dataset, Grid, Measurements, Truth};
use crate::robot::Robot;

/// Largest number of inversion steps for planning, where the last digits do not matter.
const PLANNING_STEPS: usize = 30;

pub(super) fn normal(rng: &mut ChaCha8Rng, sd: f64) -> f64 {
    sd * rng.sample::<f64, _>(StandardNormal)
}

/// A planned pose and the tensions that balance it.
#[derive(Debug, Clone)]
pub(crate) struct PlannedRow {
    /// Label of the pose, which determines the time.
    pub label: i64,
    /// Pose of the platform.
    pub pose: Pose,
    /// Tensions (N).
    pub tensions_n: Vec<f64>,
}

/// Noise-free readings with the platform exactly at these poses of a robot exactly as described;
/// the home pose is the first if there is one.
///
/// # Errors
/// If the kinematics has no solution at one of them.
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
    let directions = true_directions(robot, &poses)?;
    invert_within(PLANNING_STEPS, &mut exact, (&poses, &tensions), &directions)?;
    Ok(exact.measurements)
}

/// Rows in which everything but the readings is filled in.
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

/// Raw readings of the nominal sensors at the true tensions.
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

/// Direction of travel of every cable to every pose: the sign of the change of its geometric length.
pub(crate) fn true_directions(robot: &Robot, poses: &[Pose]) -> Result<Grid, SimulationError> {
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
