//! Tensions that balance the platform of a robot with effects.

use super::workspace::TensionRange;
use crate::effect::{BetterKnown, BoundEffect, Dual, PlatformPorts, PoseContexts, is_slack};
use crate::geometry::{Pose, Twist};
use crate::kinematics::{KinematicsError, resting_pose};
use crate::measurement::Measurements;
use crate::robot::Robot;

/// Largest number of fixed-point steps between tensions and the geometry that depends on them.
const MAX_STEPS: usize = 30;
/// Largest change of a tension at convergence (N).
const TENSION_TOLERANCE_N: f64 = 1e-11;

/// Time between poses (s).
const SECONDS_PER_POSE: f64 = 30.0;

/// Label, time and temperature of the rows of a simulated run.
pub(super) struct Schedule {
    pub labels: Vec<i64>,
    pub time_s: Vec<f64>,
    pub temperature_c: Vec<f64>,
}

impl Schedule {
    /// Schedule up to and including row `last`.
    pub fn of(robot: &Robot, last: usize) -> Self {
        let first = i64::from(robot.home.is_none());
        Self::at((first..).take(last + 1).collect())
    }

    /// Schedule of poses with these labels, which determine the time.
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

    /// Epoch of a row of [`Self::of`], whatever its length.
    pub fn epoch_of(robot: &Robot, row: usize) -> Epoch {
        let time_s = SECONDS_PER_POSE * row as f64;
        Epoch {
            label: i64::from(robot.home.is_none()) + row as i64,
            time_s,
            temperature_c: ambient_temperature_c(time_s),
        }
    }
}

/// Temperature of the hall (degrees Celsius) at a time (s) of a simulated run: 20 plus a slow oscillation of 2.
#[must_use]
pub fn ambient_temperature_c(time_s: f64) -> f64 {
    20.0 + 2.0 * (time_s / 3600.0).sin()
}

/// Label, time and temperature of one pose of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Epoch {
    /// Label of the pose in the measurements.
    pub label: i64,
    /// Time (s).
    pub time_s: f64,
    /// Temperature (degrees Celsius).
    pub temperature_c: f64,
}

/// One pose of a run. Effects count time and temperature from the first pose.
pub(super) struct Visit<'a> {
    /// The first pose, unless this is the first.
    pub first: Option<(Epoch, &'a Pose)>,
    pub epoch: Epoch,
    pub pose: &'a Pose,
    /// Velocity and acceleration of the platform there (m, rad, s; base frame).
    pub motion: [Twist; 2],
}

impl<'a> Visit<'a> {
    /// The same visit of another pose.
    pub fn at<'b>(&'b self, pose: &'b Pose) -> Visit<'b>
    where
        'a: 'b,
    {
        Visit { pose, ..*self }
    }
}

/// The robot with its geometry and weight as changed by the effects at a visit under `tensions` (N).
fn robot_under_effects(
    truth: &Robot,
    effects: &[BoundEffect],
    visit: &Visit<'_>,
    tensions: &[f64],
) -> Robot {
    let first = visit.first.into_iter();
    let (epochs, poses): (Vec<Epoch>, Vec<Pose>) = first
        .chain([(visit.epoch, visit.pose)])
        .map(|(epoch, pose)| (epoch, *pose))
        .unzip();
    let data = Measurements {
        labels: epochs.iter().map(|at| at.label).collect(),
        time_s: epochs.iter().map(|at| at.time_s).collect(),
        temperature_c: epochs.iter().map(|at| at.temperature_c).collect(),
        ..Measurements::default()
    };
    let home = truth.home.map(|_| 0);
    let contexts = PoseContexts::new(truth, &data, home, &poses, BetterKnown::default());
    let row = poses.len() - 1;
    let mut robot = truth.clone();
    let constants = |values: &[f64]| -> Vec<Dual> {
        values.iter().map(|value| Dual::constant(*value)).collect()
    };
    let mut platform = PlatformPorts::nominal(truth);
    let ports = contexts.cable_ports(row, truth, effects, tensions);
    for (cable, ports) in robot.cables.iter_mut().zip(ports) {
        ports.change_geometry(cable);
    }
    for bound in effects {
        let values = constants(&bound.values);
        bound.change_platform(&values, contexts.at_row(row), &mut platform);
    }
    robot.platform.mass_kg = truth.platform.mass_kg.map(|_| platform.mass.value);
    robot.platform.center_of_mass_m = platform.center_of_mass.map(|dual| dual.value);
    robot
}

/// Tensions (N) that balance the platform at a visit under the effects; zero where tension is not modelled, `None` if
/// no tensions within the range do.
pub(super) fn holding_tensions(
    truth: &Robot,
    effects: &[BoundEffect],
    visit: &Visit<'_>,
    range: &TensionRange,
) -> Result<Option<Vec<f64>>, KinematicsError> {
    if !truth.has_tensions() {
        return Ok(Some(vec![0.0; truth.cable_count()]));
    }
    let pose = visit.pose;
    let label = visit.epoch.label;
    let cables = 0..truth.cable_count();
    let is_slack = |cable: &usize| effects.iter().any(|one| is_slack(one, *cable, label));
    let slack: Vec<usize> = cables.filter(is_slack).collect();
    let mut tensions = range.tensions_in_motion(truth, pose, &visit.motion, &slack)?;
    if effects.is_empty() {
        return Ok(tensions);
    }
    // With a compliant frame the geometry depends on the tensions.
    for _ in 0..MAX_STEPS {
        let Some(before) = tensions.take() else {
            break;
        };
        let robot = robot_under_effects(truth, effects, visit, &before);
        tensions = range.tensions_in_motion(&robot, pose, &visit.motion, &slack)?;
        let converged = tensions.as_ref().is_some_and(|now| {
            let steps = now.iter().zip(&before).map(|(a, b)| (a - b).abs());
            steps.fold(0.0, f64::max) < TENSION_TOLERANCE_N
        });
        if converged {
            break;
        }
    }
    Ok(tensions)
}

/// The pose near that of a visit at which the platform rests under the effects, with its tensions (N) as [`holding_tensions`]:
/// that of the visit itself, unless the platform hangs freely; `None` if there is none.
pub(super) fn resting_state(
    truth: &Robot,
    effects: &[BoundEffect],
    visit: &Visit<'_>,
    range: &TensionRange,
) -> Result<Option<(Pose, Vec<f64>)>, KinematicsError> {
    let mut pose = *visit.pose;
    if !truth.hangs_freely() {
        let held = holding_tensions(truth, effects, visit, range)?;
        return Ok(held.map(|tensions| (pose, tensions)));
    }
    let mut tensions = vec![range.reference_n; truth.cable_count()];
    for _ in 0..MAX_STEPS {
        let robot = robot_under_effects(truth, effects, &visit.at(&pose), &tensions);
        let Some(rest) = resting_pose(&robot, &pose)? else {
            break;
        };
        (pose, tensions) = rest;
        if let Some(held) = holding_tensions(truth, effects, &visit.at(&pose), range)? {
            return Ok(Some((pose, held)));
        }
    }
    Ok(None)
}

/// A pose that is visited directly after home, if the robot has one.
pub(crate) struct AfterHome<'a> {
    pub robot: &'a Robot,
    pub effects: &'a [BoundEffect],
    pub range: &'a TensionRange,
}

impl AfterHome<'_> {
    /// Tensions that balance the platform there; as [`holding_tensions`].
    pub fn tensions(&self, pose: &Pose) -> Result<Option<Vec<f64>>, KinematicsError> {
        self.visit(pose, |visit| {
            holding_tensions(self.robot, self.effects, visit, self.range)
        })
    }

    /// The pose near it at which the platform rests, as [`resting_state`]; the pose itself if there is none.
    pub fn resting_pose(&self, pose: Pose) -> Pose {
        if !self.robot.hangs_freely() {
            return pose;
        }
        let rest = self.visit(&pose, |visit| {
            resting_state(self.robot, self.effects, visit, self.range)
        });
        rest.ok().flatten().map_or(pose, |(pose, _)| pose)
    }

    fn visit<T>(&self, pose: &Pose, then: impl FnOnce(&Visit<'_>) -> T) -> T {
        let home = self.robot.home.map(|home| home.pose());
        let visited = usize::from(home.is_some());
        let epoch = |row| Schedule::epoch_of(self.robot, row);
        then(&Visit {
            first: home.as_ref().map(|home| (epoch(0), home)),
            epoch: epoch(visited),
            pose,
            motion: [Twist::zeros(); 2],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::presets;

    #[test]
    fn the_epoch_of_a_row_is_that_of_the_schedule() {
        let mut robot = presets::find("mini").unwrap().robot;
        for _ in 0..2 {
            let schedule = Schedule::of(&robot, 400);
            for row in [0, 1, 7, 400] {
                let expected = Epoch {
                    label: schedule.labels[row],
                    time_s: schedule.time_s[row],
                    temperature_c: schedule.temperature_c[row],
                };
                assert_eq!(Schedule::epoch_of(&robot, row), expected);
            }
            robot.home = None;
        }
    }
}
