//! Projection of a model on a description that can express less, such as the parameters of a firmware.
//!
//! The winches of the model pay out `L_ij` at pose j (m, cable i, since home or absolute). A target with the parameters `p`
//! expects `L_ij - e_ij(p)`. It errs least with
//!
//! ```text
//! minimise  sum_ij (e_ij(p) / s)^2 + sum_k ((p_k - p0_k) / t_k)^2,    s = 0.01 mm,
//! ```
//!
//! where `p0` are the parameters that the target has and `t_k` is the range in which a parameter may deviate from there: the
//! second term decides where the poses do not. The platform of a robot that is commanded with `p` misses pose j by the position
//! rows of `J^+ e_j`, with the derivative `J` of the lengths with respect to the pose.

use nalgebra::DMatrix;

use crate::effect::{BetterKnown, PoseContexts};
use crate::estimation::{EstimationError, Globals, Method, Problem, residuals_in};
use crate::fitting::{CurveFitOptions, CurveProblem, fit_curve};
use crate::geometry::Pose;
use crate::kinematics::{KinematicsError, length_gradients, position_response};
use crate::measurement::{Dataset, Grid, Measurements};
use crate::robot::{ForceSensor, PerAxis, Robot};
use crate::simulation::{
    SimulationError, SimulationOptions, TrueGeometry, Workspace, simulate, true_directions,
};

/// Length error that weighs as much as a parameter at the limit of its search (m).
const LENGTH_SD_M: f64 = 1e-5;
/// Change of a length (m) up to which it is rounding.
const ROUNDING_M: f64 = 1e-9;

/// Lengths that a model predicts for its winches at poses of its workspace.
#[derive(Debug, Clone)]
pub struct ExpectedLengths {
    measurements: Measurements,
    poses: Vec<Pose>,
    tensions_n: Grid,
    directions: Grid,
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
        let (poses, tensions_n) = (simulated.truth.poses, simulated.truth.tension_n);
        Ok(Self {
            directions: true_directions(&model, &poses)?,
            // Tensions as read by perfect sensors; the target has no other instruments.
            measurements: Measurements {
                labels: simulated.labels,
                time_s: simulated.time_s,
                temperature_c: simulated.temperature_c,
                revolutions: simulated.revolutions,
                length_m: simulated.length_m,
                force_n: tensions_n.clone(),
                ..Measurements::default()
            },
            tensions_n,
            poses,
        })
    }

    /// Distance by which the platform of a machine that knows `target` misses the poses (m), root mean square.
    ///
    /// # Errors
    /// If the target has an unknown effect, or no cable path at a pose.
    pub fn position_error_m(&self, target: &Robot) -> Result<f64, SimulationError> {
        let errors = self.length_errors_m(target)?;
        let mut square_sum = 0.0;
        for (pose, errors) in self.poses.iter().zip(errors.chunks(target.cable_count())) {
            square_sum += missed_by_m(target, pose, errors)?.powi(2);
        }
        Ok((square_sum / self.poses.len().max(1) as f64).sqrt())
    }

    fn length_errors_m(&self, target: &Robot) -> Result<Vec<f64>, EstimationError> {
        let mut dataset = Dataset {
            robot: target.clone(),
            measurements: self.measurements.clone(),
        };
        for cable in &mut dataset.robot.cables {
            cable.force_sensor = Some(ForceSensor::OF_TENSION);
        }
        let problem = Problem::new(&dataset)?.with_method(Method::Simple);
        let known = BetterKnown {
            directions: Some(&self.directions),
            tensions_n: Some(&self.tensions_n),
        };
        let home = problem.home_row();
        let contexts =
            PoseContexts::new(&dataset.robot, &self.measurements, home, &self.poses, known);
        let rows: Vec<usize> = (0..self.poses.len()).collect();
        let globals = Globals::nominal(&problem);
        let at = (&rows[..], &self.poses[..]);
        let residuals = residuals_in(Some(contexts.into()), &problem, &globals, at);
        let mut errors: Vec<Vec<f64>> = residuals.into_iter().map(|row| row.length_m).collect();
        // At home, revolutions are zero by definition.
        if let Some(home) = home {
            errors[home].fill(0.0);
        }
        Ok(errors.concat())
    }

    /// The parameters near `start`, each within about its positive range, with which the robot of `target` errs least.
    #[must_use]
    pub fn project(
        &self,
        target: &dyn Fn(&[f64]) -> Option<Robot>,
        start: &[f64],
        ranges: &[f64],
    ) -> Vec<f64> {
        let errors_at =
            |values: &[f64]| target(values).and_then(|robot| self.length_errors_m(&robot).ok());
        let at_start = errors_at(start);
        // A parameter that changes no length would follow the rounding in its derivative.
        let matters = |k: &usize| {
            let mut moved = start.to_vec();
            moved[*k] += ranges[*k];
            match (&at_start, errors_at(&moved)) {
                (Some(errors), Some(moved)) => {
                    let mut changes = errors.iter().zip(&moved).map(|(a, b)| (a - b).abs());
                    changes.any(|change| change > ROUNDING_M)
                }
                _ => true,
            }
        };
        let free: Vec<usize> = (0..start.len())
            .filter(|k| ranges[*k] > 0.0 && matters(k))
            .collect();
        if free.is_empty() {
            return start.to_vec();
        }
        let parameters = |steps: &[f64]| -> Vec<f64> {
            let mut values = start.to_vec();
            for (k, step) in free.iter().zip(steps) {
                values[*k] += step * ranges[*k];
            }
            values
        };
        let lengths = self.poses.len() * self.tensions_n.columns();
        let predict = |steps: &[f64], out: &mut [f64]| {
            out.fill(f64::NAN);
            if let Some(errors) = errors_at(&parameters(steps)) {
                let weighted = errors.iter().map(|error| error / LENGTH_SD_M);
                let all: Vec<f64> = weighted.chain(steps.iter().copied()).collect();
                out.copy_from_slice(&all);
            }
        };
        let problem = CurveProblem {
            observations: &vec![0.0; lengths + free.len()],
            sd: None,
            predict: &predict,
            jacobian: None,
        };
        let options = CurveFitOptions {
            max_iterations: 50,
            ..CurveFitOptions::default()
        };
        let fit = fit_curve(&problem, &vec![0.0; free.len()], &options);
        parameters(fit.statistics.parameters.as_slice())
    }
}

/// The model without effects that act in motion or at single poses, and with exactly known places of the pulleys, which
/// otherwise displace its poses.
fn at_rest(model: &Robot) -> Robot {
    let mut at_rest = model.clone();
    at_rest.effects.retain(|setting| {
        let effect = model.effect(&setting.effect);
        effect.is_none_or(|effect| !effect.is_in_motion() && effect.pose_parameter().is_none())
    });
    for cable in &mut at_rest.cables {
        cable.pulley.entry_point_sd_m = PerAxis::known(0.0);
    }
    at_rest
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::EffectSetting;
    use crate::robot::presets;

    /// A target with entry points and drums that may be moved, and without pulleys if it has none.
    fn target(nominal: &Robot, radius: f64, values: &[f64]) -> Robot {
        let mut robot = nominal.clone();
        for (cable, values) in robot.cables.iter_mut().zip(values.chunks(4)) {
            cable.pulley.radius_m *= radius;
            for (coordinate, value) in cable.pulley.entry_point_m.iter_mut().zip(values) {
                *coordinate += value;
            }
            cable.winch.drum_diameter_m *= 1.0 + values[3];
        }
        robot
    }

    #[test]
    fn what_a_target_expresses_is_found_and_the_rest_is_its_error() {
        let preset = presets::find("mini").expect("a preset");
        let nominal = preset.robot;
        let scale = EffectSetting {
            effect: "winch_scale".into(),
            targets: vec!["cable-3".into()],
            parameters: [("scale".to_owned(), 0.004)].into(),
        };
        let mut model = nominal.clone();
        model.cables[1].pulley.entry_point_m[0] += 0.003;
        model.effects = vec![scale];
        let expected = ExpectedLengths::of(&model, preset.workspace, 40).expect("lengths");
        let error_m = |target: &Robot| expected.position_error_m(target).expect("an error");
        assert!(error_m(&nominal) > 2e-4, "{}", error_m(&nominal));
        let (start, ranges) = (vec![0.0; 32], vec![0.05; 32]);
        let with_pulleys = |values: &[f64]| Some(target(&nominal, 1.0, values));
        let found = expected.project(&with_pulleys, &start, &ranges);
        let rest_m = error_m(&target(&nominal, 1.0, &found));
        assert!(rest_m < 2e-6, "{rest_m}");
        assert!((found[4] - 0.003).abs() < 1e-5, "{found:?}");
        assert!((found[11] - 0.004).abs() < 1e-4, "{found:?}");
        let without = |values: &[f64]| Some(target(&nominal, 0.0, values));
        let best = expected.project(&without, &start, &ranges);
        let [unfitted, best] =
            [&start, &best].map(|values| error_m(&target(&nominal, 0.0, values)));
        assert!(best < 0.3 * unfitted && best > 1e-5, "{best} {unfitted}");
    }
}
