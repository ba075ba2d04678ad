//! One cell of a study: robot, poses and expected accuracy of a combination.

use nalgebra::{DMatrix, DVector};
use tautline_core::estimation::{Parameter, ParameterId};
use tautline_core::geometry::Pose;
use tautline_core::planning::{
    Expectation, PlanError, PlanOptions, PoseSet, expect, iso_9283_poses, position_jacobians,
};
use tautline_core::robot::{Inclinometer, Robot, TargetPlane};
use tautline_core::simulation::Workspace;
use tautline_session::{Catalogue, Sensor};

use crate::design::Combination;
use crate::scaling::{scaled, size_m};

/// Thermal expansion of a steel frame (1/K), for the error per kelvin.
const STEEL_PER_K: f64 = 12e-6;

/// Planning options of a study: without clearance to the frame and limits of the laser range, since robots may have any
/// size.
#[must_use]
pub fn options(poses: usize, seed: u64, size_m: f64) -> PlanOptions<'static> {
    PlanOptions {
        min_frame_distance_m: 0.02 * size_m.min(1.0),
        laser_range_m: [0.0, 10.0 * size_m.max(1.0)],
        ..PlanOptions::new(poses, seed)
    }
}

/// The robot of a cell: scaled, with the instruments of its combination.
///
/// # Errors
/// If a sensor is unknown, or the robot lacks what is varied or becomes invalid.
pub fn robot_of(base: &Robot, cell: &Combination, catalogue: &Catalogue) -> Result<Robot, String> {
    let mut robot = match cell.size_m {
        Some(size) => scaled(base, size / size_m(base)),
        None => base.clone(),
    };
    set_laser(&mut robot, &cell.laser, catalogue)?;
    if let Some(sd_m) = cell.home_sd_m {
        let home = robot
            .home
            .as_mut()
            .ok_or_else(|| lacks(base, "home pose", "home_sd_m"))?;
        if home.position_sd_m > 0.0 {
            home.orientation_sd_rad *= sd_m / home.position_sd_m;
        }
        home.position_sd_m = sd_m;
        home.covariance = None;
    }
    match cell.inclinometer_sd_rad {
        Some(0.0) => robot.inclinometer = None,
        Some(sd_rad) => robot.inclinometer = Some(Inclinometer { sd_rad }),
        None => {}
    }
    for cable in &mut robot.cables {
        if let Some(sd_m) = cell.length_sd_m {
            cable.winch.length_sd_m = sd_m;
        }
        if let Some(sd_n) = cell.tension_sd_n {
            let sensor = cable.force_sensor.as_mut();
            sensor
                .ok_or_else(|| lacks(base, "force sensors", "tension_sd_n"))?
                .tension_sd_n = sd_n;
        }
    }
    robot
        .check()
        .map_err(|error| format!("{}{}: {}", base.name, error.pointer, error.message))?;
    Ok(robot)
}

fn lacks(robot: &Robot, what: &str, axis: &str) -> String {
    format!(
        "/design/{axis}: the robot \"{}\" has no {what}, expected robots that have them",
        robot.name
    )
}

fn set_laser(robot: &mut Robot, name: &str, catalogue: &Catalogue) -> Result<(), String> {
    match name {
        "own" => {}
        "none" => robot.laser = None,
        _ => {
            let at = |message: String| format!("/design/lasers: {message}, \"own\" or \"none\"");
            let sensor = catalogue.find(name).map_err(at)?;
            let sd_m = reading_sd_m(robot, sensor);
            let missing = lacks(robot, "laser", "lasers");
            robot.laser.as_mut().ok_or(missing)?.sd_m = sd_m;
        }
    }
    Ok(())
}

/// Standard deviation (m) of the readings of a sensor over the distances to the target plane in the workspace.
#[must_use]
pub fn reading_sd_m(robot: &Robot, sensor: &Sensor) -> f64 {
    sensor.reading_sd_m(laser_distances_m(robot))
}

/// Minimum and maximum distance (m) to the target plane over the workspace, at the orientation of its centre.
#[must_use]
pub fn laser_distances_m(robot: &Robot) -> [f64; 2] {
    let Some(laser) = &robot.laser else {
        return [0.0; 2];
    };
    let workspace = Workspace::of(robot);
    let TargetPlane {
        normal, offset_m, ..
    } = laser.target_plane;
    let origin = workspace.centre.transform(&laser.origin_m.into());
    let normal = tautline_core::geometry::Vec3::from(normal);
    let middle = (offset_m - normal.dot(&origin)).abs();
    let half: f64 = (0..3)
        .map(|k| (normal[k] * workspace.half_extent_m[k]).abs())
        .sum();
    [(middle - half).max(0.0), middle + half]
}

/// A cell, ready for prediction and simulation.
#[derive(Debug, Clone)]
pub struct Cell {
    /// The robot.
    pub robot: Robot,
    /// The poses, without home.
    pub poses: Vec<Pose>,
    set: PoseSet,
    targets: Vec<DMatrix<f64>>,
}

impl Cell {
    /// Prepares a cell.
    ///
    /// # Errors
    /// If a pose cannot be held or there is nothing to identify.
    pub fn new(
        robot: Robot,
        poses: Vec<Pose>,
        method: tautline_core::estimation::Method,
    ) -> Result<Self, PlanError> {
        let options = PlanOptions {
            method,
            ..options(poses.len(), 0, size_m(&robot))
        };
        let set = expect(&robot, &poses, &options)?;
        let targets = iso_9283_poses(&Workspace::of(&robot));
        let targets = position_jacobians(&robot, &targets, set.parameters());
        Ok(Self {
            targets: targets.unwrap_or_default(),
            robot,
            poses,
            set,
        })
    }

    /// The estimated parameters.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        self.set.parameters()
    }

    /// Expected accuracy after all poses.
    #[must_use]
    pub fn expected(&self) -> Expectation {
        self.set.after(self.poses.len())
    }

    /// Root mean square position error over the workspace (m) caused by errors of the parameters.
    #[must_use]
    pub fn position_m(&self, errors: &DVector<f64>) -> Option<f64> {
        let weights = self.set.position_weights()?;
        Some(errors.dot(&(weights * errors)).max(0.0).sqrt())
    }

    /// Mean distance (m) between the five commanded poses of ISO 9283 and those attained with errors of the parameters: AP
    /// without the repeatability of the robot.
    #[must_use]
    pub fn accuracy_of_poses_m(&self, errors: &DVector<f64>) -> Option<f64> {
        let distances = self.targets.iter().map(|target| (target * errors).norm());
        (!self.targets.is_empty()).then(|| distances.sum::<f64>() / self.targets.len() as f64)
    }

    /// Root mean square position error per kelvin (m/K) by which a steel frame is warmer than at calibration; the frame
    /// expands about the origin of the base frame.
    #[must_use]
    pub fn position_m_per_kelvin(&self) -> Option<f64> {
        let errors = self
            .parameters()
            .iter()
            .map(|parameter| match parameter.id {
                ParameterId::EntryPoint { cable, axis } => {
                    STEEL_PER_K * self.robot.cables[cable].pulley.entry_point_m[axis]
                }
                _ => 0.0,
            });
        let errors: Vec<f64> = errors.collect();
        self.position_m(&DVector::from_vec(errors))
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::planning::random_poses;
    use tautline_core::robot::presets;

    use super::*;
    use crate::file::{Choice, Method};

    fn combination() -> Combination {
        Combination {
            robot: 0,
            size_m: None,
            laser: "own".into(),
            poses: 10,
            choice: Choice::Random,
            home_sd_m: None,
            inclinometer_sd_rad: None,
            length_sd_m: None,
            tension_sd_n: None,
            method: Method::Joint,
            is_simulated: false,
        }
    }

    #[test]
    fn a_combination_changes_what_it_names() {
        let mini = presets::find("mini").expect("there").robot;
        let catalogue = Catalogue::with(None).expect("valid");
        let same = robot_of(&mini, &combination(), &catalogue).expect("a robot");
        assert_eq!(same, mini);
        let changed = Combination {
            laser: "class-3mm".into(),
            home_sd_m: Some(5e-5),
            inclinometer_sd_rad: Some(1e-3),
            length_sd_m: Some(1e-5),
            tension_sd_n: Some(0.2),
            ..combination()
        };
        let robot = robot_of(&mini, &changed, &catalogue).expect("a robot");
        assert_eq!(robot.laser.expect("there").sd_m, 3e-3);
        let home = robot.home.expect("there");
        assert_eq!(
            (home.position_sd_m, home.orientation_sd_rad),
            (5e-5, 2.5e-4)
        );
        assert_eq!(robot.inclinometer.expect("there").sd_rad, 1e-3);
        let unknown = Combination {
            laser: "class-9mm".into(),
            ..combination()
        };
        let message = robot_of(&mini, &unknown, &catalogue).expect_err("refused");
        assert!(
            message.starts_with("/design/lasers: found \"class-9mm\", expected"),
            "{message}"
        );
    }

    #[test]
    fn the_distances_of_mini_are_those_of_its_workspace() {
        let mini = presets::find("mini").expect("there").robot;
        let [near, far] = laser_distances_m(&mini);
        assert!((near - 0.245).abs() < 1e-9 && (far - 0.645).abs() < 1e-9);
    }

    #[test]
    fn errors_of_all_parameters_of_their_size_give_the_expected_error() {
        let mini = presets::find("mini").expect("there").robot;
        let poses = random_poses(&mini, &options(15, 1, 1.0)).expect("poses");
        let cell = Cell::new(mini, poses, Method::Joint.of_solver()).expect("a cell");
        let expected = cell.expected();
        assert!(expected.criteria.platform_m.expect("known") > 0.0);
        let none = DVector::zeros(cell.parameters().len());
        assert_eq!(cell.position_m(&none), Some(0.0));
        assert_eq!(cell.accuracy_of_poses_m(&none), Some(0.0));
        // 12 um per metre and kelvin, over the half metre of MINI from its middle.
        let per_kelvin = cell.position_m_per_kelvin().expect("known");
        assert!((1e-7..1e-5).contains(&per_kelvin), "{per_kelvin}");
    }
}
