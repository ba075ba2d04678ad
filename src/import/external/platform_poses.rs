//! Pose of the platform at each measured pose: as commanded, otherwise from the cable lengths.

use tautline_core::geometry::Pose;
use tautline_core::kinematics::{ForwardKinematics, inverse_kinematics};
use tautline_core::robot::Robot;

use super::{orientation, vector};
use crate::cutting::CutPose;
use crate::recipe::{Quantity, QuantityKind as Kind};

/// Lengths agree with the drawing within this share of the frame's size.
const DRAWN_WITHIN: f64 = 0.02;

/// Poses of the platform in the robot's frame; `None` if neither source yields one. Stretch and sag are neglected: their effect
/// is far below the accuracy needed.
pub(super) fn platform_poses(poses: &[CutPose], robot: &Robot) -> Vec<Option<Pose>> {
    let home = robot.home.map(|home| home.pose());
    let upright = home.unwrap_or_else(Pose::identity).orientation;
    let commanded = |pose: &CutPose| {
        Some(Pose {
            position: vector(pose, Kind::Commanded)?,
            orientation: orientation(pose, Kind::Commanded).unwrap_or(upright),
        })
    };
    let commanded: Vec<Option<Pose>> = poses.iter().map(commanded).collect();
    if commanded.iter().any(Option::is_some) {
        return commanded;
    }
    let (Ok(forward), Some(frame_m)) = (ForwardKinematics::new(robot), robot.frame_size_m()) else {
        return commanded;
    };
    let forward = forward.with_residual_limit(DRAWN_WITHIN * frame_m);
    let start = home.unwrap_or(*forward.centre());
    let home_lengths = home.and_then(|home| inverse_kinematics(robot, &home).ok());
    let length = |pose: &CutPose, index: usize| {
        let reading = |kind| pose.readings.get(&Quantity { kind, index }).map(|r| r.mean);
        let cable = &robot.cables[index];
        let counted = home_lengths.as_ref().and_then(|states| {
            let paid = cable.winch.cable_per_revolution_m() * reading(Kind::Revolutions)?;
            Some(states[index].length_m + paid)
        });
        counted
            .or_else(|| reading(Kind::Length))
            .unwrap_or(f64::NAN)
    };
    let mut from = start;
    let by_lengths = |pose: &CutPose| {
        let lengths: Vec<f64> = (0..robot.cable_count()).map(|k| length(pose, k)).collect();
        let found = forward.solve(&lengths, &from);
        found.converged.then(|| {
            from = found.pose;
            found.pose
        })
    };
    poses.iter().map(by_lengths).collect()
}
