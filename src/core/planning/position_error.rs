//! Position error of the platform of a controller whose parameters have errors.
//!
//! A controller whose encoders count from home commands `l(x; p) - l(x_home; p)`. With parameters that are off by `dp`
//! and lengths that are reached exactly, the platform misses its target by `dx = J^+ (dl/dp (x) - dl/dp (x_home)) dp`,
//! `J = dl/dx`; contradicting lengths are met in the least-squares sense. So the mean square position error over
//! targets is `dp^T M dp`, and its expectation with the covariance `C` of the parameters is `tr(M C)` (I-optimality; Atkinson,
//! Donev, Tobias, Optimum Experimental Designs, 2007). Tensions are assumed not to change.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::estimation::{Parameter, ParameterId};
use crate::geometry::Pose;
use crate::kinematics::{KinematicsError, LengthGradient, length_gradients, position_response};
use crate::robot::Robot;
use crate::simulation::Workspace;

/// Number of targets drawn over the workspace.
const TARGETS: usize = 100;
/// Seed of the targets: the same for every plan, so that plans can be compared.
const SEED: u64 = 1;

/// Weights `M` of errors of the parameters over a volume, whose rotations do not count; `None` for a robot without home pose or if no target has cable paths.
pub fn position_weights(
    robot: &Robot,
    workspace: &Workspace,
    parameters: &[Parameter],
) -> Option<DMatrix<f64>> {
    let home = length_gradients(robot, &robot.home?.pose()).ok()?;
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let targets = (0..TARGETS).map(|_| Pose {
        orientation: workspace.centre.orientation,
        ..workspace.draw(robot, &mut rng)
    });
    let errors: Vec<DMatrix<f64>> = targets
        .filter_map(|target| {
            position_error_jacobian(robot, &home, &target, parameters)
                .ok()
                .flatten()
        })
        .collect();
    let mut sum = DMatrix::zeros(parameters.len(), parameters.len());
    for error in &errors {
        sum.gemm_tr(1.0, error, error, 1.0);
    }
    (!errors.is_empty()).then(|| sum / errors.len() as f64)
}

/// Derivative of the position that a controller reaches at each target with respect to the parameters (3 x parameters each), see
/// [`PoseSet::position_weights`](super::PoseSet::position_weights); `None` for a robot without home pose or where a target has no
/// cable path.
#[must_use]
pub fn position_jacobians(
    robot: &Robot,
    targets: &[Pose],
    parameters: &[Parameter],
) -> Option<Vec<DMatrix<f64>>> {
    let home = length_gradients(robot, &robot.home?.pose()).ok()?;
    let at = |target| {
        position_error_jacobian(robot, &home, target, parameters)
            .ok()
            .flatten()
    };
    targets.iter().map(at).collect()
}

/// Derivative of the position reached at a target with respect to the parameters, 3 rows.
fn position_error_jacobian(
    robot: &Robot,
    home: &[LengthGradient],
    target: &Pose,
    parameters: &[Parameter],
) -> Result<Option<DMatrix<f64>>, KinematicsError> {
    let there = length_gradients(robot, target)?;
    let freedom = robot.platform.freedom();
    let coordinates = freedom.coordinates();
    let by_pose = DMatrix::from_fn(there.len(), coordinates.len(), |i, k| {
        there[i].pose[coordinates[k].index()]
    });
    let by_parameter = DMatrix::from_fn(there.len(), parameters.len(), |i, k| {
        match parameters[k].id {
            ParameterId::EntryPoint { cable, axis } if cable == i => {
                there[i].entry_point[axis] - home[i].entry_point[axis]
            }
            ParameterId::Home(coordinate) => -home[i].pose[coordinate.index()],
            _ => 0.0,
        }
    });
    Ok(position_response(by_pose, &by_parameter, freedom))
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::geometry::Coordinate;
    use crate::robot::presets;
    use crate::simulation::{Epoch, QuasiStaticRobot};

    /// A controller with wrong parameters moves the platform to a target, and it rests where the cables put it.
    #[test]
    fn a_wrong_parameter_moves_the_platform_as_predicted() {
        let preset = presets::find("mini").unwrap();
        let mut robot = preset.robot;
        for cable in &mut robot.cables {
            // Lengths of elastic cables follow the tensions, which are not part of the prediction.
            cable.cable.axial_stiffness_n = Some(1e12);
        }
        let robot = &robot;
        let epoch = |label| Epoch {
            label,
            time_s: 0.0,
            temperature_c: 20.0,
        };
        let target = Pose::from_parts([0.1, -0.06, 0.08], [1.0, 0.0, 0.0, 0.0]);
        let home = length_gradients(robot, &robot.home.unwrap().pose()).unwrap();
        let (off, z) = (1e-4, Coordinate::Z);
        let entry = ParameterId::EntryPoint { cable: 4, axis: 0 };
        for id in [entry, ParameterId::Home(z)] {
            let mut believed = robot.clone();
            match &id {
                ParameterId::EntryPoint { cable, axis } => {
                    believed.cables[*cable].pulley.entry_point_m[*axis] += off;
                }
                _ => believed.home.as_mut().unwrap().position_m[2] += off,
            }
            let parameter = Parameter {
                id: id.clone(),
                name: String::new(),
                unit: "m",
                prior_sd: None,
            };
            let expected = position_error_jacobian(robot, &home, &target, &[parameter])
                .unwrap()
                .unwrap();
            let real = QuasiStaticRobot::new(robot.clone(), preset.tension, epoch(0)).unwrap();
            let believed = QuasiStaticRobot::new(believed, preset.tension, epoch(0)).unwrap();
            let wanted = believed.at(epoch(1), &target, &target).unwrap();
            let revolutions = wanted.readings.revolutions.row(0);
            let rest = real.at_revolutions(epoch(1), &target, (revolutions, &target));
            let moved = (rest.unwrap().pose.position - target.position) / off;
            let moved = DVector::from_column_slice(moved.as_slice());
            let difference = (&moved - expected.column(0)).norm();
            // Tensions change a little with the geometry, and with them the elastic lengths.
            assert!(
                difference < 0.03 * moved.norm(),
                "{id:?} {moved} {expected}"
            );
        }
    }
}
