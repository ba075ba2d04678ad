//! Projection of a model on a description that can express less, such as the parameters of a firmware.
//!
//! The winches of the model pay out `L_ij` at pose j (m, cable i, since home or absolute). A target with the parameters `p`
//! expects `L_ij - e_ij(p)`. It errs least with
//!
//!     minimise  sum_ij (e_ij(p) / s)^2 + sum_k ((p_k - p0_k) / t_k)^2,    s = 0.1 mm,
//!
//! where `p0` are the parameters that the target has and `t_k` how far a parameter may be sought from there: it decides where the
//! poses do not. The platform of a robot that is commanded with `p` misses pose j by the position rows of `J^+ e_j`, with
//! the derivative `J` of the lengths with respect to the pose.

use nalgebra::DMatrix;

use crate::effect::{BetterKnown, BoundEffect, PoseContexts};
use crate::estimation::{EstimationError, Globals, Method, Problem, residuals_in};
use crate::fitting::{CurveFitOptions, CurveProblem, fit_curve};
use crate::geometry::Pose;
use crate::kinematics::{KinematicsError, length_gradients, position_response};
use crate::measurement::{Dataset, Grid, Measurements};
use crate::robot::{PerAxis, Robot};
use crate::simulation::{
    SimulationError, SimulationOptions, TrueGeometry, Workspace, simulate, true_directions,
};

/// Length error that weighs as much as a parameter at the limit of its search (m).
const LENGTH_SD_M: f64 = 1e-4;

/// What a model expects of its winches at poses of its workspace.
#[derive(Debug, Clone)]
pub struct ExpectedLengths {
    measurements: Measurements,
    poses: Vec<Pose>,
    tensions_n: Grid,
    directions: Grid,
}

/// Errors of a target at the poses of [`ExpectedLengths`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ProjectionErrors {
    /// Errors of the cable lengths, cable by cable at each pose (m).
    pub length_m: Vec<f64>,
    /// Distance by which the platform misses each pose (m).
    pub position_m: Vec<f64>,
}

/// Root mean square.
fn rms(values: &[f64]) -> f64 {
    let square_sum: f64 = values.iter().map(|value| value * value).sum();
    (square_sum / values.len().max(1) as f64).sqrt()
}

impl ProjectionErrors {
    /// Root mean square of the length errors (m).
    #[must_use]
    pub fn length_rms_m(&self) -> f64 {
        rms(&self.length_m)
    }

    /// Root mean square of the position errors (m).
    #[must_use]
    pub fn position_rms_m(&self) -> f64 {
        rms(&self.position_m)
    }

    /// Largest position error (m).
    #[must_use]
    pub fn largest_position_m(&self) -> f64 {
        self.position_m.iter().copied().fold(0.0, f64::max)
    }
}

impl ExpectedLengths {
    /// The lengths of `model` at poses drawn from a workspace, without noise. Effects of single poses and of motion are
    /// left out.
    ///
    /// # Errors
    /// If the cables cannot hold the platform there, or an effect does not exist.
    pub fn of(model: &Robot, workspace: Workspace, poses: usize) -> Result<Self, SimulationError> {
        let model = at_rest(model);
        let options = SimulationOptions {
            geometry: TrueGeometry::Nominal,
            noise: false,
            workspace: Some(workspace),
            ..SimulationOptions::new(poses, 1)
        };
        let simulated = simulate(&model, &options)?.dataset.measurements;
        let poses = simulated.truth.poses;
        Ok(Self {
            tensions_n: simulated.truth.tension_n,
            directions: true_directions(&model, &poses)?,
            // The target has no other instruments.
            measurements: Measurements {
                labels: simulated.labels,
                time_s: simulated.time_s,
                temperature_c: simulated.temperature_c,
                revolutions: simulated.revolutions,
                length_m: simulated.length_m,
                ..Measurements::default()
            },
            poses,
        })
    }

    /// Errors of a controller or simulator that knows `target`.
    ///
    /// # Errors
    /// If the target has another number of cables, an unknown effect, or no cable path at a pose.
    pub fn errors_of(&self, target: &Robot) -> Result<ProjectionErrors, SimulationError> {
        let length_m = self.length_errors_m(target)?;
        let cables = target.cable_count();
        let position_m = self.poses.iter().zip(length_m.chunks(cables));
        let position_m = position_m.map(|(pose, errors)| missed_by_m(target, pose, errors));
        Ok(ProjectionErrors {
            position_m: position_m.collect::<Result<_, _>>()?,
            length_m,
        })
    }

    fn length_errors_m(&self, target: &Robot) -> Result<Vec<f64>, EstimationError> {
        let dataset = Dataset {
            robot: target.clone(),
            measurements: self.measurements.clone(),
        };
        let problem = Problem::new(&dataset)?.with_method(Method::Simple);
        let known = BetterKnown {
            directions: Some(&self.directions),
            tensions_n: Some(&self.tensions_n),
        };
        let home = problem.home_row();
        let contexts = PoseContexts::new(target, &self.measurements, home, &self.poses, known);
        let rows: Vec<usize> = (0..self.poses.len()).collect();
        let globals = Globals::nominal(&problem);
        let at = (&rows[..], &self.poses[..]);
        let residuals = residuals_in(Some(contexts.into()), &problem, &globals, at);
        let rows = residuals.iter().enumerate();
        // At home, revolutions are zero by definition.
        let of_row = |(row, residual): (usize, &crate::estimation::RowResidual)| {
            let zero = vec![0.0; target.cable_count()];
            if Some(row) == home {
                zero
            } else {
                residual.length_m.clone()
            }
        };
        Ok(rows.flat_map(of_row).collect())
    }

    /// The parameters near `start`, each within about its range, with which the robot of `target` errs least. A parameter with the
    /// range 0 stays as it is.
    #[must_use]
    pub fn project(
        &self,
        target: &dyn Fn(&[f64]) -> Option<Robot>,
        start: &[f64],
        ranges: &[f64],
    ) -> Vec<f64> {
        let sought: Vec<usize> = (0..start.len()).filter(|k| ranges[*k] > 0.0).collect();
        let parameters = |steps: &[f64]| {
            let mut all = start.to_vec();
            for (k, step) in sought.iter().zip(steps) {
                all[*k] += step * ranges[*k];
            }
            all
        };
        if sought.is_empty() {
            return start.to_vec();
        }
        let lengths = self.poses.len() * self.tensions_n.columns();
        let predict = |steps: &[f64], out: &mut [f64]| {
            out.fill(f64::NAN);
            let errors = target(&parameters(steps)).map(|robot| self.length_errors_m(&robot));
            if let Some(Ok(errors)) = errors
                && errors.len() == lengths
            {
                out[..lengths].copy_from_slice(&errors);
                out[..lengths]
                    .iter_mut()
                    .for_each(|error| *error /= LENGTH_SD_M);
                out[lengths..].copy_from_slice(steps);
            }
        };
        let problem = CurveProblem {
            observations: &vec![0.0; lengths + sought.len()],
            sd: None,
            predict: &predict,
            jacobian: None,
        };
        let options = CurveFitOptions {
            max_iterations: 50,
            ..CurveFitOptions::default()
        };
        let fit = fit_curve(&problem, &vec![0.0; sought.len()], &options);
        parameters(fit.statistics.parameters.as_slice())
    }
}

/// The model without effects that act in motion or at single poses, and with entry points that are not drawn.
fn at_rest(model: &Robot) -> Robot {
    let mut model = model.clone();
    let whole = model.clone();
    model.effects.retain(|setting| {
        BoundEffect::from_setting(setting, &whole).map_or(true, |bound| {
            !bound.effect.is_in_motion() && bound.effect.pose_parameter().is_none()
        })
    });
    for cable in &mut model.cables {
        cable.pulley.entry_point_sd_m = PerAxis::known(0.0);
    }
    model
}

/// Distance by which the platform misses a pose with these errors of its cable lengths (m).
fn missed_by_m(robot: &Robot, pose: &Pose, errors_m: &[f64]) -> Result<f64, KinematicsError> {
    let gradients = length_gradients(robot, pose)?;
    let freedom = robot.platform.freedom();
    let by_pose = DMatrix::from_fn(gradients.len(), freedom.count(), |i, k| {
        gradients[i].pose[freedom.coordinates()[k].index()]
    });
    let errors = DMatrix::from_column_slice(errors_m.len(), 1, errors_m);
    let moved = position_response(by_pose, &errors, freedom);
    Ok(moved.map_or(f64::NAN, |moved| moved.norm()))
}
