//! The robot as effects make it at one pose: what holds the platform there.

use super::workspace::TensionRange;
use crate::effect::{BoundEffect, Circumstances, Dual, PlatformPorts};
use crate::geometry::Pose;
use crate::kinematics::KinematicsError;
use crate::measurement::Measurements;
use crate::robot::Robot;

/// Most steps for tensions and a geometry that depends on them, and the change that ends them (N).
const LOAD_STEPS: usize = 30;
const SETTLED_N: f64 = 1e-11;

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
            temperature_c: time_s.iter().map(|t| ambient_temperature_c(*t)).collect(),
            time_s,
        }
    }

    /// Of a row of [`Self::of`], however long that is.
    pub fn moment_of(robot: &Robot, row: usize) -> Moment {
        let time_s = SECONDS_PER_POSE * row as f64;
        Moment {
            label: i64::from(robot.home.is_none()) + row as i64,
            time_s,
            temperature_c: ambient_temperature_c(time_s),
        }
    }
}

/// Temperature of the hall (degrees Celsius) at a time (s) of a simulated run: 20 with a slow wave of 2.
#[must_use]
pub fn ambient_temperature_c(time_s: f64) -> f64 {
    20.0 + 2.0 * (time_s / 3600.0).sin()
}

/// When a pose is visited, and what it is called.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Label of the pose in the measurements.
    pub label: i64,
    /// Time (s).
    pub time_s: f64,
    /// Temperature (degrees Celsius).
    pub temperature_c: f64,
}

/// The row that is asked for, and the first one where that is another.
pub(super) struct Rows<'a> {
    pub first: Option<(Moment, &'a Pose)>,
    pub moment: Moment,
    pub pose: &'a Pose,
}

/// The robot with what effects change of its geometry and weight at the last of the `rows` under `tensions`
/// (N).
fn loaded_robot(
    truth: &Robot,
    effects: &[BoundEffect],
    rows: &Rows<'_>,
    tensions: &[f64],
) -> Robot {
    let first = rows.first.into_iter();
    let (moments, poses): (Vec<Moment>, Vec<Pose>) = first
        .chain([(rows.moment, rows.pose)])
        .map(|(moment, pose)| (moment, *pose))
        .unzip();
    let data = Measurements {
        labels: moments.iter().map(|at| at.label).collect(),
        time_s: moments.iter().map(|at| at.time_s).collect(),
        temperature_c: moments.iter().map(|at| at.temperature_c).collect(),
        ..Measurements::default()
    };
    let home = truth.home.map(|_| 0);
    let circumstances = Circumstances::new(truth, &data, home, &poses, None);
    let row = poses.len() - 1;
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

/// Tensions that hold the platform at the last of the `rows`, as the effects make it and its cables; zero
/// where tension is not modelled, `None` where no tensions within the range do.
pub(super) fn hold(
    truth: &Robot,
    effects: &[BoundEffect],
    rows: &Rows<'_>,
    range: &TensionRange,
) -> Result<Option<Vec<f64>>, KinematicsError> {
    if truth.platform.mass_kg.is_none() || !truth.has_force_sensors() {
        return Ok(Some(vec![0.0; truth.cable_count()]));
    }
    let pose = rows.pose;
    let mut tensions = range.tensions(truth, pose)?;
    if effects.is_empty() {
        return Ok(tensions);
    }
    // A frame that yields makes the geometry depend on the tensions.
    for _ in 0..LOAD_STEPS {
        let Some(before) = tensions.take() else {
            break;
        };
        let robot = loaded_robot(truth, effects, rows, &before);
        tensions = range.tensions(&robot, pose)?;
        let settled = tensions.as_ref().is_some_and(|now| {
            let steps = now.iter().zip(&before).map(|(a, b)| (a - b).abs());
            steps.fold(0.0, f64::max) < SETTLED_N
        });
        if settled {
            break;
        }
    }
    Ok(tensions)
}

/// Tensions that hold the platform at a pose visited right after home, if the robot has one; as [`hold`].
pub(crate) fn hold_after_home(
    robot: &Robot,
    effects: &[BoundEffect],
    pose: &Pose,
    range: &TensionRange,
) -> Result<Option<Vec<f64>>, KinematicsError> {
    let home = robot.home.map(|home| home.pose());
    let visited = usize::from(home.is_some());
    let moment = |row| Schedule::moment_of(robot, row);
    let rows = Rows {
        first: home.as_ref().map(|home| (moment(0), home)),
        moment: moment(visited),
        pose,
    };
    hold(robot, effects, &rows, range)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::presets;

    #[test]
    fn the_moment_of_a_row_is_that_of_the_schedule() {
        let mut robot = presets::find("mini").unwrap().robot;
        for _ in 0..2 {
            let schedule = Schedule::of(&robot, 400);
            for row in [0, 1, 7, 400] {
                let expected = Moment {
                    label: schedule.labels[row],
                    time_s: schedule.time_s[row],
                    temperature_c: schedule.temperature_c[row],
                };
                assert_eq!(Schedule::moment_of(&robot, row), expected);
            }
            robot.home = None;
        }
    }
}
