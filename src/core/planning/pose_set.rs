//! Expected accuracy of a given sequence of poses, without candidates to select from.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::candidates::{Candidate, Frame, accept, draw_pose};
use super::information_model::InformationModel;
use super::{
    Accuracy, Expectation, Goal, PlanError, PlanOptions, Refused, position_weights,
    with_tension_margin,
};
use crate::estimation::{ExpectedInformation, Parameter, covariance_of};
use crate::geometry::{Pose, Vec3};
use crate::robot::Robot;
use crate::simulation::{PlannedRow, TensionRange, Workspace};

/// Number of poses tried for each one wanted before giving up.
const TRIES_PER_POSE: usize = 200;

/// Information of a sequence of poses on the parameters, and the resulting accuracy at the controller.
#[derive(Debug, Clone)]
pub struct PoseSet {
    information: ExpectedInformation,
    weights: Option<DMatrix<f64>>,
    /// The poses with the tensions that balance them.
    rows: Vec<PlannedRow>,
    range: TensionRange,
}

impl PoseSet {
    /// The parameters that will be estimated, in the order of the expectations.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.information.parameters
    }

    /// Weights `M` by which errors `dp` of the parameters give the mean square position error over the
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

    /// Accuracy after each of the given numbers of poses, which must be ascending.
    #[must_use]
    pub fn accuracy_after(&self, counts: &[usize]) -> Vec<Accuracy> {
        let mut total = self.information.common.clone();
        let mut done = 0;
        let mut after = |count: &usize| {
            let count = (*count).clamp(done, self.information.poses.len());
            self.information.add(done..count, &mut total);
            done = count;
            let covariance = covariance_of(&total);
            Accuracy::of(
                self.parameters(),
                self.weights.as_ref(),
                covariance.as_ref(),
            )
        };
        counts.iter().map(&mut after).collect()
    }

    /// The first `count` poses with the same tensions, measured by the instruments and with the standard deviations of `robot`,
    /// which is otherwise the robot that this set was made for.
    ///
    /// # Errors
    /// If there is nothing to identify, or the robot cannot be simulated.
    pub fn measured_by(
        &self,
        robot: &Robot,
        count: usize,
        options: &PlanOptions<'_>,
    ) -> Result<Self, PlanError> {
        let rows = &self.rows[..count.min(self.rows.len())];
        let options = PlanOptions {
            poses: rows.len(),
            ..options.clone()
        };
        let model = InformationModel::new(robot, &options, self.range)?;
        let information = model.information(rows.iter().cloned())?;
        Ok(Self {
            weights: (self.weights.as_ref())
                .map(|weights| rearranged(weights, self.parameters(), &information.parameters)),
            information,
            rows: rows.to_vec(),
            range: self.range,
        })
    }
}

/// Reorders the weights of parameters; parameters that are new have no weight, as they do not move the platform.
fn rearranged(weights: &DMatrix<f64>, from: &[Parameter], to: &[Parameter]) -> DMatrix<f64> {
    let place = |new: &Parameter| from.iter().position(|old| old.id == new.id);
    let places: Vec<Option<usize>> = to.iter().map(place).collect();
    DMatrix::from_fn(to.len(), to.len(), |i, j| {
        (places[i].zip(places[j])).map_or(0.0, |place| weights[place])
    })
}

/// Expected information of measuring `poses` in this order; goal, effects, method and limits are those of the options.
///
/// # Errors
/// If a pose cannot be held, there is nothing to identify, or the robot cannot be simulated.
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
    let rows = rows?;
    let information = model.information(rows.iter().cloned())?;
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
        weights: position_weights(&model.robot, &within, &information.parameters),
        information,
        rows,
        range,
    })
}

/// Draws random poses that can be held and measured, as [`plan`](super::plan) draws its candidates.
///
/// # Errors
/// If the robot can hold too few poses.
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

/// The five poses of ISO 9283: the centre of the workspace and four points on a diagonal plane of its box, at 80 % of
/// the diagonals (the standard uses the largest cube inside the workspace).
#[must_use]
pub fn iso_9283_poses(workspace: &Workspace) -> [Pose; 5] {
    let half = workspace.half_extent_m;
    let at = |[x, y, z]: [f64; 3]| Pose {
        position: workspace.centre.position
            + 0.8 * Vec3::new(x * half[0], y * half[1], z * half[2]),
        ..workspace.centre
    };
    // The plane contains one lower edge and the opposite upper one.
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
    use crate::robot::{Inclinometer, presets};

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

    /// Other instruments change the set of parameters; the stored quantities of the poses remain valid.
    #[test]
    fn other_instruments_at_the_same_poses_promise_what_they_do_from_the_beginning() {
        let robot = presets::find("mini").unwrap().robot;
        let options = PlanOptions::new(12, 3);
        let poses = random_poses(&robot, &options).unwrap();
        let set = expect(&robot, &poses, &options).unwrap();
        let mut other = robot.clone();
        other.laser = None;
        other.inclinometer = Some(Inclinometer { sd_rad: 1e-3 });
        other.home.as_mut().unwrap().position_sd_m *= 0.5;
        for robot in [&robot, &other] {
            let again = set.measured_by(robot, 9, &options).unwrap();
            let anew = expect(robot, &poses[..9], &options).unwrap();
            assert_eq!(again.parameters(), anew.parameters());
            // Products of matrices of another size round differently.
            let same =
                |a: Option<f64>, b: Option<f64>| (a.unwrap() / b.unwrap() - 1.0).abs() < 1e-9;
            let counts = [6, 6, 9];
            for (count, accuracy) in counts.into_iter().zip(again.accuracy_after(&counts)) {
                let criteria = anew.after(count).criteria;
                assert!(same(accuracy.mean_m, criteria.mean_m), "{count}");
                assert!(same(accuracy.platform_m, criteria.platform_m), "{count}");
            }
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
