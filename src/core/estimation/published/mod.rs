//! Identification of entry points as published: Jin et al. 2018, equations 5 to 12.
//!
//! The parameters `V` are chosen coordinates of the entry points `a_i`; the others are taken as
//! given. For given `V` the forward kinematics of every pose is solved from its measured lengths
//! `l_ij = L0_ij (1 + T_ij/EA_i) - D_i` with `L0_ij = (D_i + l_i(home))/(1 + T_i,home/EA_i) + k_i rev_ij`
//! (m), and
//!
//! `Error(V) = [l_i(r_j, R_j) - l_ij for all cables and poses; h_j - laser_j for all poses]` (m),
//!
//! with the predicted laser distance `h_j = (h - n.o_j)/(n.q_j)`, beam `o_j = r_j + R_j o_L`,
//! `q_j = R_j q_L`, and the plane offset `h` that explains the laser reading at home exactly. Then
//! `V <- V - lambda pinv(dError/dV) Error` with a forward-difference Jacobian.
//!
//! There are no priors and no weights, and home pose and tensions count as exact: this is for comparison, not for use where
//! the joint estimate is available. With wrongly given coordinates the result can be worse than the
//! drawing it starts from.
//!
//! The difference steps are those of the reference `peers/scipy/jin2018.py`. They are so short that
//! rounding decides the iterates of MINI from about 0.1 mm down, in any implementation; with longer
//! ones in both, the iterates agree within a nanometre. Where the lengths hardly depend on a motion, as on the
//! rotation of a platform whose anchors lie on the lines to the entry points, plain Newton does not
//! converge and the method stays near its start, in the reference too.

mod newton;
mod readings;

use nalgebra::{DMatrix, DVector};

use crate::kinematics::KinematicsError;
use crate::measurement::Dataset;
use crate::robot::Robot;
use newton::PlainNewton;
use readings::Readings;

/// Singular values below this fraction of the largest count as zero (NumPy's `pinv`).
const RELATIVE_CUTOFF: f64 = 1e-15;

/// One coordinate of one entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EntryCoordinate {
    /// Index of the cable, from 0.
    pub cable: usize,
    /// Axis of the base frame: 0, 1, 2 for x, y, z.
    pub axis: usize,
}

/// Options of the published method: parameters and stopping rules.
#[derive(Debug, Clone, PartialEq)]
pub struct PublishedOptions {
    /// The parameters `V`.
    pub parameters: Vec<EntryCoordinate>,
    /// Entry points (m) whose coordinates outside `V` are taken as given; `None`: the robot's own.
    /// The coordinates in `V` always start from the robot's own.
    pub given_entry_points_m: Option<Vec<[f64; 3]>>,
    /// Step factor `lambda` of equation 12.
    pub step_factor: f64,
    /// Stops when no parameter changes by as much (m).
    pub step_stop_m: f64,
    /// Stops when the norm of the error is below this (m), `E_stop`; 0: never.
    pub error_stop_m: f64,
    /// Largest number of steps.
    pub iteration_limit: usize,
    /// Step of the forward differences of the error by the parameters (m).
    pub parameter_difference_m: f64,
    /// Step of the forward differences of the lengths by the pose (m, rad).
    pub pose_difference: f64,
}

impl PublishedOptions {
    /// The choices of the paper, with `V` as in [`published_parameters`].
    #[must_use]
    pub fn for_robot(robot: &Robot) -> Self {
        Self {
            parameters: published_parameters(robot),
            given_entry_points_m: None,
            step_factor: 0.5,
            step_stop_m: 1e-7,
            error_stop_m: 0.0,
            iteration_limit: 60,
            parameter_difference_m: 1e-6,
            pose_difference: 1e-7,
        }
    }
}

/// The parameters `V` of the paper, `[x2..x7, y2..y7, z5..z8]` for eight cables; for `m` cables
/// `x` and `y` of all but the first and last, `z` of the upper half, each only where the platform
/// is free to move along that axis.
#[must_use]
pub fn published_parameters(robot: &Robot) -> Vec<EntryCoordinate> {
    let m = robot.cable_count();
    let freedom = robot.platform.freedom();
    let inner = 1..m.saturating_sub(1).max(1);
    let ranges = [inner.clone(), inner, m.div_ceil(2)..m];
    let axes = ranges.into_iter().enumerate();
    let moved = axes.filter(|(axis, _)| freedom.coordinates().iter().any(|c| c.index() == *axis));
    moved
        .flat_map(|(axis, cables)| cables.map(move |cable| EntryCoordinate { cable, axis }))
        .collect()
}

/// Errors of [`identify_published`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PublishedError {
    /// A prerequisite of the method is missing.
    #[error("the published method needs {what}")]
    Missing {
        /// The prerequisite.
        what: &'static str,
    },
    /// A cell is empty.
    #[error("the published method needs {what} at every pose, pose {label} has none")]
    EmptyCell {
        /// The reading.
        what: &'static str,
        /// Label of the pose.
        label: i64,
    },
    /// A part of the model that the method does not include.
    #[error("the published method cannot include {what}")]
    NotModelled {
        /// The part of the model.
        what: &'static str,
    },
    /// A parameter is not a coordinate of the robot, or the number of given entry points is not that of the
    /// cables.
    #[error("a parameter or given entry point does not fit a robot with {cables} cables")]
    Parameters {
        /// Number of cables of the robot.
        cables: usize,
    },
    /// The robot's geometry cannot be used.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
}

/// Reason why the iteration stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PublishedStop {
    /// No parameter changed by as much as the limit.
    SmallStep,
    /// The error is below its limit.
    SmallError,
    /// The number of steps was reached.
    IterationLimit,
    /// The error is no longer a finite number: forward kinematics by plain Newton has diverged.
    Diverged,
}

/// State after one step.
#[derive(Debug, Clone, PartialEq)]
pub struct PublishedIterate {
    /// Entry points (m).
    pub entry_points_m: Vec<[f64; 3]>,
    /// Norm of the error (m).
    pub error_norm_m: f64,
}

/// Result of the published method.
#[derive(Debug, Clone, PartialEq)]
pub struct PublishedResult {
    /// Identified entry points (m), the given ones included.
    pub entry_points_m: Vec<[f64; 3]>,
    /// State at the start and after every step.
    pub history: Vec<PublishedIterate>,
    /// Number of steps taken.
    pub iterations: usize,
    /// Reason why the iteration stopped.
    pub stop: PublishedStop,
}

/// Identifies entry points by the published method.
///
/// # Errors
/// If home pose, laser, force sensors or a reading is missing, or the options do not fit the robot.
pub fn identify_published(
    dataset: &Dataset,
    options: &PublishedOptions,
) -> Result<PublishedResult, PublishedError> {
    let mut entries = start(&dataset.robot, options)?;
    let mut problem = Problem {
        readings: Readings::new(dataset)?,
        newton: PlainNewton::new(&dataset.robot, options.pose_difference)?,
    };
    problem.readings.choose_starts(dataset, &entries)?;
    let mut error = problem.error(&entries);
    let mut history = vec![iterate(&entries, &error)];
    let mut stop = PublishedStop::IterationLimit;
    for _ in 0..options.iteration_limit {
        let Some(step) = problem.step(&mut entries, &error, options) else {
            stop = PublishedStop::Diverged;
            break;
        };
        for (parameter, change) in options.parameters.iter().zip(&step) {
            entries[parameter.cable][parameter.axis] += change;
        }
        error = problem.error(&entries);
        history.push(iterate(&entries, &error));
        if let Some(reason) = stop_reason(&step, error.norm(), options) {
            stop = reason;
            break;
        }
    }
    Ok(PublishedResult {
        entry_points_m: entries,
        iterations: history.len() - 1,
        history,
        stop,
    })
}

fn iterate(entries: &[[f64; 3]], error: &DVector<f64>) -> PublishedIterate {
    PublishedIterate {
        entry_points_m: entries.to_vec(),
        error_norm_m: error.norm(),
    }
}

fn stop_reason(step: &[f64], error_norm: f64, options: &PublishedOptions) -> Option<PublishedStop> {
    let largest = step.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    if !error_norm.is_finite() {
        Some(PublishedStop::Diverged)
    } else if largest < options.step_stop_m {
        Some(PublishedStop::SmallStep)
    } else if error_norm < options.error_stop_m {
        Some(PublishedStop::SmallError)
    } else {
        None
    }
}

/// Entry points at the start: given ones, but the robot's own in the coordinates of `V`.
fn start(robot: &Robot, options: &PublishedOptions) -> Result<Vec<[f64; 3]>, PublishedError> {
    let cables = robot.cable_count();
    let own = robot.cables.iter().map(|c| c.pulley.entry_point_m);
    let own: Vec<[f64; 3]> = own.collect();
    let mut entries = options.given_entry_points_m.clone().unwrap_or(own.clone());
    let outside = |p: &EntryCoordinate| p.cable >= cables || p.axis >= 3;
    if entries.len() != cables || options.parameters.iter().any(outside) {
        return Err(PublishedError::Parameters { cables });
    }
    for p in &options.parameters {
        entries[p.cable][p.axis] = own[p.cable][p.axis];
    }
    Ok(entries)
}

/// The error function of equation 10 and its Newton step.
struct Problem {
    readings: Readings,
    newton: PlainNewton,
}

impl Problem {
    /// Equation 10: length residuals of all poses, then laser residuals.
    fn error(&mut self, entries: &[[f64; 3]]) -> DVector<f64> {
        let readings = &self.readings;
        self.newton.set_entry_points(entries);
        let home_lengths = self.newton.lengths(&readings.home);
        let lengths = readings.measured_lengths(&home_lengths);
        let found = self.newton.solve(&lengths, &readings.starts);
        let lasers = found.poses.iter().zip(&readings.laser_m);
        let lasers = lasers.map(|(pose, reading)| readings.laser_at(pose) - reading);
        let residuals = found.residuals.iter().copied();
        DVector::from_vec(residuals.chain(lasers).collect())
    }

    /// `-lambda pinv(J) Error`, `None` if the Jacobian is not finite.
    fn step(
        &mut self,
        entries: &mut [[f64; 3]],
        error: &DVector<f64>,
        options: &PublishedOptions,
    ) -> Option<Vec<f64>> {
        let parameters = &options.parameters;
        let difference = options.parameter_difference_m;
        let mut jacobian = DMatrix::zeros(error.len(), parameters.len());
        for (column, p) in parameters.iter().enumerate() {
            let value = entries[p.cable][p.axis];
            entries[p.cable][p.axis] = value + difference;
            let slope = (self.error(entries) - error) / difference;
            entries[p.cable][p.axis] = value;
            jacobian.set_column(column, &slope);
        }
        let solution = pseudo_inverse_times(jacobian, error)?;
        let step = solution.iter().map(|v| -options.step_factor * v);
        Some(step.collect())
    }
}

/// `pinv(matrix) vector` by singular values, `None` if they cannot be computed.
fn pseudo_inverse_times(matrix: DMatrix<f64>, vector: &DVector<f64>) -> Option<DVector<f64>> {
    if matrix.ncols() == 0 {
        return Some(DVector::zeros(0));
    }
    // The iteration for singular values does not end on NaN.
    if !matrix.iter().chain(vector).all(|v| v.is_finite()) {
        return None;
    }
    let svd = matrix.try_svd(true, true, f64::EPSILON, 10_000)?;
    let cutoff = RELATIVE_CUTOFF * svd.singular_values.max();
    svd.solve(vector, cutoff).ok()
}

#[cfg(test)]
mod tests;
