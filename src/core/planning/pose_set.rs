//! What a given sequence of poses promises, pose after pose, without candidates to compare with.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::candidates::{Candidate, Frame, accept, draw_pose};
use super::information_model::InformationModel;
use super::{
    Expectation, Goal, PlanError, PlanOptions, Refused, position_error, with_tension_margin,
};
use crate::estimation::{ExpectedInformation, Parameter};
use crate::geometry::{Pose, Vec3};
use crate::robot::Robot;
use crate::simulation::{TensionRange, Workspace};

/// Poses tried for each one wanted before giving up.
const TRIES_PER_POSE: usize = 200;

/// Information of a sequence of poses on the parameters, and what it is worth at the controller.
#[derive(Debug, Clone)]
pub struct PoseSet {
    information: ExpectedInformation,
    weights: Option<DMatrix<f64>>,
}

impl PoseSet {
    /// The parameters that will be estimated, in the order of the expectations.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.information.parameters
    }

    /// The weights `M` with which errors `dp` of the parameters make the mean square of the position error over the
    /// workspace, `dp^T M dp` (m^2); parameters x parameters. `None` for a robot without home pose.
    #[must_use]
    pub fn position_weights(&self) -> Option<&DMatrix<f64>> {
        self.weights.as_ref()
    }

    /// Expectation after the first `count` poses.
    #[must_use]
    pub fn after(&self, count: usize) -> Expectation {
        let count = count.min(self.information.poses.len());
        Expectation::of(&self.information, self.weights.as_ref(), 0..count)
    }
}

/// What measuring `poses` in this order promises; goal, effects, method and limits are those of the options.
///
/// # Errors
/// If a pose cannot be held, nothing is to be identified, or the robot cannot be simulated.
pub fn expect(
    robot: &Robot,
    poses: &[Pose],
    options: &PlanOptions<'_>,
) -> Result<PoseSet, PlanError> {
    let options = PlanOptions {
        poses: poses.len(),
        ..options.clone()
    };
    with_tension_margin(robot, &options, |options, range| {
        expect_within(robot, poses, options, range)
    })
}

fn expect_within(
    robot: &Robot,
    poses: &[Pose],
    options: &PlanOptions<'_>,
    range: TensionRange,
) -> Result<PoseSet, PlanError> {
    let model = InformationModel::new(robot, options, range)?;
    let rows: Result<Vec<_>, PlanError> = (1..)
        .zip(poses)
        .zip(model.labels())
        .map(|((number, pose), label)| {
            let held = Candidate::chosen(&model, *pose).ok_or(PlanError::NotHeld { number })?;
            Ok(held.row(label))
        })
        .collect();
    let information = model.information(rows?.into_iter())?;
    if information.parameters.is_empty() {
        return Err(PlanError::NothingToEstimate);
    }
    let within = match options.goal {
        Goal::Accuracy(volume) => {
            (model.workspace).of_volume(volume.centre_m(), volume.half_extent_m())
        }
        _ => model.workspace,
    };
    Ok(PoseSet {
        weights: position_error::weights(&model.robot, &within, &information.parameters),
        information,
    })
}

/// So many poses at random that can be held and measured, as [`plan`](super::plan) draws its candidates.
///
/// # Errors
/// If the robot cannot be held at enough poses.
pub fn random_poses(robot: &Robot, options: &PlanOptions<'_>) -> Result<Vec<Pose>, PlanError> {
    with_tension_margin(robot, options, |options, range| {
        let model = InformationModel::new(robot, options, range)?;
        let frame = Frame::of(&model, options.min_frame_distance_m);
        let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
        let mut refused = Refused::default();
        let mut found = Vec::with_capacity(options.poses);
        while found.len() < options.poses {
            if refused.tried >= TRIES_PER_POSE * options.poses {
                return Err(PlanError::TooFewPoses {
                    found: found.len(),
                    wanted: options.poses,
                    refused,
                });
            }
            refused.tried += 1;
            let pose = draw_pose(&model, &mut rng);
            let accepted = accept(&model, options, &frame, pose, &mut refused);
            found.extend(accepted.map(|candidate| candidate.pose));
        }
        Ok(found)
    })
}

/// Derivative of the position that a controller reaches at each target by the parameters (3 x parameters each), see
/// [`PoseSet::position_weights`]; `None` for a robot without home pose or where a target has no cable path.
#[must_use]
pub fn position_jacobians(
    robot: &Robot,
    targets: &[Pose],
    parameters: &[Parameter],
) -> Option<Vec<DMatrix<f64>>> {
    position_error::jacobians(robot, targets, parameters)
}

/// Five poses as ISO 9283 chooses them: the centre of the workspace and four places on a plane across its box, at 80 % of
/// the diagonals (the standard takes the largest cube inside of it).
#[must_use]
pub fn iso_9283_poses(workspace: &Workspace) -> [Pose; 5] {
    let half = workspace.half_extent_m;
    let at = |[x, y, z]: [f64; 3]| Pose {
        position: workspace.centre.position
            + 0.8 * Vec3::new(x * half[0], y * half[1], z * half[2]),
        ..workspace.centre
    };
    // The plane holds one edge below and the opposite one above.
    let corners = [
        [1.0, 1.0, 1.0],
        [1.0, -1.0, 1.0],
        [-1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
    ];
    let [a, b, c, d] = corners.map(at);
    [workspace.centre, a, b, c, d]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::Control;
    use crate::planning::{evaluate, plan};
    use crate::robot::presets;

    #[test]
    fn a_sequence_promises_what_its_plan_does() {
        for name in ["mini", "suspended"] {
            let preset = presets::find(name).unwrap();
            let options = PlanOptions {
                candidates: 60,
                ..PlanOptions::new(12, 3)
            };
            let quiet = &mut |_: &_| Control::Continue;
            let planned = plan(&preset.robot, &options, quiet).unwrap();
            let poses: Vec<Pose> = planned.poses.iter().map(|planned| planned.pose).collect();
            let set = expect(&preset.robot, &poses, &options).unwrap();
            assert_eq!(set.parameters(), planned.parameters());
            assert_eq!(set.after(12), planned.expected, "{name}");
            assert_eq!(set.after(7), planned.after(7), "{name}");
        }
    }

    #[test]
    fn random_poses_can_be_measured() {
        let robot = presets::find("mini").unwrap().robot;
        let options = PlanOptions {
            candidates: 20,
            ..PlanOptions::new(20, 5)
        };
        let poses = random_poses(&robot, &options).unwrap();
        assert_eq!(poses.len(), 20);
        assert_eq!(poses, random_poses(&robot, &options).unwrap());
        evaluate(&robot, &poses, &options, &mut |_| Control::Continue).unwrap();
        let nothing = PlanOptions {
            laser_range_m: [50.0, 60.0],
            ..options
        };
        let error = random_poses(&robot, &nothing).unwrap_err();
        assert!(matches!(error, PlanError::TooFewPoses { found: 0, .. }));
    }

    #[test]
    fn the_poses_of_iso_9283_are_in_the_workspace() {
        let workspace = presets::find("hall").unwrap().workspace;
        let poses = iso_9283_poses(&workspace);
        assert!(poses.iter().all(|pose| workspace.contains(pose)));
        assert_eq!(poses[0], workspace.centre);
    }
}
