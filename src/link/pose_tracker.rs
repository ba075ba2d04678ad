//! Pose of the platform by the revolutions of its winches, within centimetres: to draw it, and as the start of a motion.

use tautline_core::geometry::Pose;
use tautline_core::kinematics::{ForwardKinematics, inverse_kinematics};
use tautline_core::robot::Robot;

use crate::controller::Sample;

/// Residual of the lengths that drawings and elongation explain (m).
const EXPLAINED_M: f64 = 0.05;

/// Pose of the platform by its encoders.
pub struct PoseTracker {
    kinematics: ForwardKinematics,
    home_lengths_m: Vec<f64>,
    per_revolution_m: Vec<f64>,
    last: Pose,
}

impl PoseTracker {
    /// From the home pose of a robot; `None` if it has none.
    #[must_use]
    pub fn of(robot: &Robot) -> Option<Self> {
        let home = robot.home?.pose();
        let states = inverse_kinematics(robot, &home).ok()?;
        let kinematics = ForwardKinematics::new(robot).ok()?;
        let cables = robot.cables.iter();
        Some(Self {
            kinematics: kinematics.with_residual_limit(EXPLAINED_M).with_starts(1),
            home_lengths_m: states.iter().map(|state| state.length_m).collect(),
            per_revolution_m: cables
                .map(|cable| cable.winch.cable_per_revolution_m())
                .collect(),
            last: home,
        })
    }

    /// The pose by the readings; the last one if they do not determine it.
    pub fn of_sample(&mut self, sample: &Sample) -> Pose {
        let paid_out = sample.revolutions.iter().zip(&self.per_revolution_m);
        let lengths_m: Vec<f64> = paid_out
            .zip(&self.home_lengths_m)
            .map(|((revolutions, per), home)| home + revolutions * per)
            .collect();
        let complete = lengths_m.len() == self.home_lengths_m.len();
        if complete && lengths_m.iter().all(|length| length.is_finite()) {
            let found = self.kinematics.solve(&lengths_m, &self.last);
            if found.residual_rms_m < EXPLAINED_M {
                self.last = found.pose;
            }
        }
        self.last
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;

    #[test]
    fn revolutions_tell_the_pose() {
        let robot = presets::find("mini").unwrap().robot;
        let home = robot.home.unwrap().pose();
        let mut there = home;
        there.position.x += 0.05;
        let lengths = |pose: &Pose| -> Vec<f64> {
            let states = inverse_kinematics(&robot, pose).unwrap();
            states.iter().map(|state| state.length_m).collect()
        };
        let per_revolution = robot
            .cables
            .iter()
            .map(|c| c.winch.cable_per_revolution_m());
        let changes = lengths(&there).into_iter().zip(lengths(&home));
        let mut sample = Sample {
            time_s: 0.0,
            revolutions: changes
                .zip(per_revolution)
                .map(|((there, home), per)| (there - home) / per)
                .collect(),
            force_n: Vec::new(),
            laser_m: None,
            temperature_c: None,
            swivel_rad: None,
            inclination_rad: None,
            commanded: None,
            started: None,
        };
        let mut whereabouts = PoseTracker::of(&robot).unwrap();
        let found = whereabouts.of_sample(&sample);
        assert!((found.position - there.position).norm() < 1e-6);
        sample.revolutions[2] = f64::NAN;
        assert_eq!(whereabouts.of_sample(&sample), found);
    }
}
