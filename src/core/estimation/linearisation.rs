//! All readings at a solution, linear in the common parameters, with the poses and the latent tensions eliminated.
//!
//! Every reading, equilibrium equation and prior is one row, in its own standard deviations: the estimate of its
//! noise. With the poses (and tensions) `x` and the common parameters `g`, rows `r + J dx + G dg`, the
//! elimination leaves `r + A dg` with `A = M G` and `M = I - J (J^T J)^-1 J^T`. Least squares in `g` is then
//! plain linear algebra on `A` and `r`, whatever the robot: score tests, angles between signatures and
//! cross-validation need nothing else.

use nalgebra::{DMatrix, DVector};

use super::analysis::ReadingKind;
use super::parameter::Parameter;

/// What a row stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowKind {
    /// A reading other than a tension, or an equilibrium equation.
    Reading(ReadingKind),
    /// The tension reading of a cable.
    Tension(usize),
    /// The prior of the parameter with this index.
    Prior(usize),
}

/// One row of a linearisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearRow {
    /// Row of the measurements; `None` for priors.
    pub row: Option<usize>,
    /// What it stands for.
    pub kind: RowKind,
    /// Standard deviation of the noise (SI units).
    pub sd: f64,
}

/// The rows of one pose.
#[derive(Debug, Clone)]
pub struct PoseBlock {
    /// Row of the measurements.
    pub row: usize,
    /// The rows of the linearisation that belong to the pose.
    pub rows: std::ops::Range<usize>,
    /// `C` with `C C^T = M`, the covariance of these rows if the common parameters were known.
    pub remainder: DMatrix<f64>,
    /// Derivative of the fitted pose (translation, rotation vector; base frame) with respect to the parameters.
    pub pose_by_parameter: DMatrix<f64>,
}

/// The linearised problem.
#[derive(Debug, Clone)]
pub struct Linearisation {
    /// Parameters, in the order of the columns.
    pub parameters: Vec<Parameter>,
    /// What the rows are: pose by pose, then those of the home pose, then priors.
    pub rows: Vec<LinearRow>,
    /// Estimated noise of each row, in its standard deviations, sign as prediction minus reading.
    pub residual: DVector<f64>,
    /// Derivative of the rows with respect to the parameters, poses and tensions following.
    pub design: DMatrix<f64>,
    /// The poses.
    pub poses: Vec<PoseBlock>,
}
