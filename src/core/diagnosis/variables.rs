//! The variables on which residuals may depend, for each row of the measurements.
//!
//! If a variable is itself a reading with considerable noise (tension, laser distance), its fitted value is used, which
//! is the reading minus its estimated error. Fitted values and residuals of least squares are uncorrelated, so the
//! residuals cannot seem to depend on a variable just because both contain the same noise.

use super::budget::{MIN_RELATIVE_SPREAD, MIN_VALUES, SAME_VALUE};
use super::{Quantity, Variable};
use crate::effect::travel;
use crate::estimation::{Linearisation, ObservationKind, Problem, RowKind, Solution};
use crate::geometry::{Pose, Vec3};
use crate::kinematics::{CablePath, PulleyGeometry};
use crate::measurement::Grid;

/// Variables of all readings at a solution.
pub struct Variables<'a> {
    problem: &'a Problem<'a>,
    /// Reference of rotations: the home pose, or the first fitted pose.
    reference: Pose,
    /// Fitted pose of each row; `None` if the row was not fitted.
    poses: Vec<Option<Pose>>,
    /// Path of each cable at each fitted pose, by cable.
    paths: Vec<Vec<Option<CablePath<f64>>>>,
    /// Fitted tensions (N).
    tension_n: Grid,
    /// Fitted laser distances (m).
    laser_m: Vec<f64>,
}

impl<'a> Variables<'a> {
    /// Evaluates the variables at `solution`, whose linearisation is `linear`.
    #[must_use]
    pub fn new(problem: &'a Problem<'a>, solution: &Solution, linear: &Linearisation) -> Self {
        let data = &problem.dataset.measurements;
        let mut poses = vec![None; data.len()];
        for (row, pose) in &solution.poses {
            poses[*row] = Some(*pose);
        }
        let home = problem.dataset.robot.home.map(|_| solution.globals.home);
        let first = solution.poses.first().map(|(_, pose)| *pose);
        let (tension_n, laser_m) = fitted_readings(problem, linear);
        Self {
            reference: home.or(first).unwrap_or_else(Pose::identity),
            paths: paths(problem, solution, &poses),
            poses,
            problem,
            tension_n,
            laser_m,
        }
    }

    /// Values of `variable` for the readings `quantity` of `cable`, one per row of the measurements, NaN where unknown.
    /// `None` if the variable does not apply to these readings, is unknown or hardly varies.
    #[must_use]
    pub fn values(
        &self,
        quantity: Quantity,
        cable: Option<usize>,
        variable: Variable,
    ) -> Option<Vec<f64>> {
        let of_cable = matches!(
            quantity,
            Quantity::Length | Quantity::Tension | Quantity::Swivel
        );
        let cable = cable.filter(|_| of_cable);
        let values = match variable {
            Variable::Time => self.since_first(&self.problem.dataset.measurements.time_s),
            Variable::Temperature => {
                self.since_first(&self.problem.dataset.measurements.temperature_c)
            }
            Variable::Distance if quantity == Quantity::Laser => self.laser_m.clone(),
            Variable::Distance => return None,
            Variable::Position(k) => self.at_poses(|pose| pose.position[k]),
            Variable::Rotation(k) => self.at_poses(|pose| pose.difference(&self.reference)[3 + k]),
            _ => self.cable_values(cable?, variable),
        };
        varies(values.iter().copied(), variable).then_some(values)
    }

    fn rows(&self) -> std::ops::Range<usize> {
        0..self.poses.len()
    }

    fn cable_values(&self, cable: usize, variable: Variable) -> Vec<f64> {
        let data = &self.problem.dataset.measurements;
        let of_path = |value: fn(&CablePath<f64>) -> f64| {
            let paths = self.paths[cable].iter();
            paths
                .map(|path| path.as_ref().map_or(f64::NAN, value))
                .collect()
        };
        match variable {
            Variable::CableLength => of_path(|path| path.length),
            Variable::WrapAngle => of_path(|path| path.wrap),
            Variable::SwivelAngle => self.swivel_angles(cable),
            Variable::Tension => self
                .rows()
                .map(|row| self.tension_n.get(row, cable))
                .collect(),
            Variable::Revolutions => self.revolutions(cable),
            Variable::DrumFraction => {
                let gear_ratio = self.problem.dataset.robot.cables[cable].winch.gear_ratio;
                let revolutions = self.revolutions(cable).into_iter();
                revolutions
                    .map(|r| (r / gear_ratio).rem_euclid(1.0))
                    .collect()
            }
            // `travel` is zero where the direction is unknown.
            _ => self
                .rows()
                .map(|row| travel(data, self.problem.home_row(), (row, cable)))
                .collect(),
        }
    }

    fn revolutions(&self, cable: usize) -> Vec<f64> {
        let data = &self.problem.dataset.measurements;
        let home = self.problem.home_row();
        let reading = |row| match home == Some(row) {
            true => 0.0,
            false => data.revolutions.get(row, cable),
        };
        self.rows().map(reading).collect()
    }

    /// Swivel angle from the zero direction of the pulley, or from the mean direction if it has none. Angles are
    /// computed from the mean direction first to avoid a jump at half a turn.
    fn swivel_angles(&self, cable: usize) -> Vec<f64> {
        let pulley = &self.problem.dataset.robot.cables[cable].pulley;
        let axis = Vec3::from(pulley.swivel_axis);
        let facing = |path: &CablePath<f64>| Vec3::from(path.facing);
        let known_paths = self.paths[cable].iter().flatten();
        let mean: Vec3 = known_paths.map(facing).sum();
        let angle = |from: &Vec3, to: &Vec3| axis.cross(from).dot(to).atan2(from.dot(to));
        let zero = pulley.swivel_zero.map(|zero| {
            let zero = Vec3::from(zero);
            angle(&(zero - axis * axis.dot(&zero)), &mean)
        });
        let angle_of = |path: &CablePath<f64>| zero.unwrap_or(0.0) + angle(&mean, &facing(path));
        let paths = self.paths[cable].iter();
        paths
            .map(|path| path.as_ref().map_or(f64::NAN, angle_of))
            .collect()
    }

    fn at_poses(&self, value: impl Fn(&Pose) -> f64) -> Vec<f64> {
        let poses = self.poses.iter();
        poses
            .map(|pose| pose.as_ref().map_or(f64::NAN, &value))
            .collect()
    }

    fn since_first(&self, column: &[f64]) -> Vec<f64> {
        let first = column.iter().copied().find(|v| v.is_finite());
        let first = first.unwrap_or(f64::NAN);
        let value = |row: usize| column.get(row).map_or(f64::NAN, |v| v - first);
        self.rows().map(value).collect()
    }
}

/// Whether the values vary enough for a test: at least six different values, or two for a direction.
pub(crate) fn varies(values: impl Iterator<Item = f64>, variable: Variable) -> bool {
    let mut sorted: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(least), Some(largest)) = (sorted.first(), sorted.last()) else {
        return false;
    };
    let spread = largest - least;
    let fewest = if variable == Variable::Direction {
        2
    } else {
        MIN_VALUES
    };
    let gaps = sorted
        .windows(2)
        .filter(|w| w[1] - w[0] > SAME_VALUE * spread);
    spread > MIN_RELATIVE_SPREAD * largest.abs().max(least.abs()) && gaps.count() + 1 >= fewest
}

/// Path of each cable at each pose, with identified entry points and the described pulleys and anchors.
fn paths(
    problem: &Problem<'_>,
    solution: &Solution,
    poses: &[Option<Pose>],
) -> Vec<Vec<Option<CablePath<f64>>>> {
    let cables = problem.dataset.robot.cables.iter();
    let paths_of = |(cable, entry): (&crate::robot::Cable, &[f64; 3])| {
        let pulley = PulleyGeometry {
            entry: *entry,
            axis: cable.pulley.swivel_axis,
            radius: cable.pulley.radius_m,
        };
        let anchor = Vec3::from(cable.platform_anchor_m);
        let path = |pose: &Pose| pulley.path_to(pose.transform(&anchor).into());
        poses.iter().map(|pose| pose.as_ref().map(path)).collect()
    };
    let pairs = cables.zip(&solution.globals.entry_points);
    pairs.map(paths_of).collect()
}

/// Fitted tensions (N) and laser distances (m): readings minus their estimated errors.
fn fitted_readings(problem: &Problem<'_>, linear: &Linearisation) -> (Grid, Vec<f64>) {
    let data = &problem.dataset.measurements;
    let robot = &problem.dataset.robot;
    let mut tension = Grid::missing(data.len(), robot.cable_count());
    for row in 0..data.len() {
        for (index, cable) in robot.cables.iter().enumerate() {
            if let Some(sensor) = cable.force_sensor {
                tension.set(row, index, sensor.tension_n(data.force_n.get(row, index)));
            }
        }
    }
    let mut laser: Vec<f64> = (0..data.len()).map(|row| data.laser_at(row)).collect();
    for (linear_row, residual) in linear.rows.iter().zip(&linear.residual) {
        let Some(row) = linear_row.row else { continue };
        let correction = residual * linear_row.sd;
        match linear_row.kind {
            // The row of a tension is the error of the reading itself: reading minus tension.
            RowKind::Observation(ObservationKind::Tension(cable)) => {
                tension.set(row, cable, tension.get(row, cable) + correction);
            }
            RowKind::Observation(ObservationKind::Laser) => laser[row] += correction,
            _ => {}
        }
    }
    (tension, laser)
}
