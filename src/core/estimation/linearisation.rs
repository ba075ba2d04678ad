//! Linearisation of all readings at a solution, with the poses and the latent tensions eliminated.
//!
//! Every reading, equilibrium equation and prior is one row, the estimate of its noise in its own standard
//! deviations. With the poses (and tensions) `x` and the common parameters `g`, rows `r + J dx + G dg`, the
//! elimination leaves `r + A dg` with `A = M G` and `M = I - J (J^T J)^-1 J^T`. Least squares in `g` is then
//! plain linear algebra on `A` and `r` for any robot: score tests, angles between signatures and
//! cross-validation need nothing else.

use nalgebra::{DMatrix, DVector};

use super::evaluated::{Evaluated, is_tension_read, sd_of};
use super::evaluator::{Elimination, Evaluator, NoiseEstimate};
use super::observation::ObservationKind;
use super::options::Division;
use super::parameter::{Parameter, ParameterId};
use super::problem::{Poses, Problem};
use super::solution::Solution;
use super::system::Priors;
use crate::kinematics::position_response;
use crate::measurement::DistanceReading;

/// Kind of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowKind {
    /// A reading or an equilibrium equation.
    Observation(ObservationKind),
    /// The prior of a tension that was not read, of the cable with this index.
    AssumedTension(usize),
    /// The prior of the parameter with this index.
    Prior(usize),
}

/// One row of a linearisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearRow {
    /// Row of the measurements; `None` for priors.
    pub row: Option<usize>,
    /// Kind of the row.
    pub kind: RowKind,
    /// Standard deviation of the noise (SI units).
    pub sd: f64,
}

/// The rows of one pose.
#[derive(Debug, Clone)]
pub struct PoseBlock {
    /// Row of the measurements.
    pub row: usize,
    /// Rows of the linearisation that belong to the pose.
    pub rows: std::ops::Range<usize>,
    /// `C` with `C C^T = M`, the covariance of these rows if the common parameters were known: one row per entry of
    /// `rows`, one column per reading except tensions.
    pub remainder: DMatrix<f64>,
    /// Derivative of the fitted pose (translation, rotation vector; base frame) with respect to the parameters:
    /// 6 x parameters (m or rad per unit of the parameter).
    pub pose_by_parameter: DMatrix<f64>,
}

/// A problem linearised at a solution.
#[derive(Debug, Clone)]
pub struct Linearisation {
    /// Parameters, in the order of the columns.
    pub parameters: Vec<Parameter>,
    /// Kinds of the rows: pose by pose, then those of the home pose, then distances, then priors.
    pub rows: Vec<LinearRow>,
    /// Estimated noise of each row, in its standard deviations, sign as prediction minus reading: one entry per row.
    pub residual: DVector<f64>,
    /// Derivative of the rows with respect to the parameters, poses and tensions re-estimated: rows x parameters (1 per
    /// unit of the parameter).
    pub design: DMatrix<f64>,
    /// Blocks of the poses.
    pub poses: Vec<PoseBlock>,
}

impl Linearisation {
    /// Linearises `problem` at `solution`, whose parameters are those of the problem.
    #[must_use]
    pub fn new(problem: &Problem<'_>, solution: &Solution) -> Self {
        let mut at = LinearisedProblem::new(problem, solution);
        let (mut blocks, mut poses) = (Vec::new(), Vec::new());
        let mut first = 0;
        for index in 0..at.pose_count() {
            let pose = at.pose(index);
            let last = first + pose.block.rows.len();
            poses.push(PoseBlock {
                row: pose.row,
                rows: first..last,
                remainder: pose.remainder,
                pose_by_parameter: pose.pose_by_parameter,
            });
            blocks.push(pose.block);
            first = last;
        }
        blocks.push(at.home());
        blocks.push(at.distances());
        blocks.push(at.priors());
        let count = blocks.iter().map(|block| block.rows.len()).sum();
        let mut design = DMatrix::zeros(count, solution.parameters.len());
        let mut first = 0;
        for block in &blocks {
            let count = block.rows.len();
            design.rows_mut(first, count).copy_from(&block.design);
            first += count;
        }
        let residuals = blocks.iter().flat_map(|block| block.residual.iter());
        Self {
            parameters: solution.parameters.clone(),
            residual: DVector::from_iterator(count, residuals.copied()),
            rows: blocks.into_iter().flat_map(|block| block.rows).collect(),
            design,
            poses,
        }
    }
}

/// Rows that belong together: those of a pose, of the home pose, or the priors.
pub(super) struct LinearBlock {
    pub rows: Vec<LinearRow>,
    /// See [`Linearisation::residual`].
    pub residual: DVector<f64>,
    /// See [`Linearisation::design`].
    pub design: DMatrix<f64>,
}

impl LinearBlock {
    fn empty(parameters: usize) -> Self {
        Self {
            rows: Vec::new(),
            residual: DVector::zeros(0),
            design: DMatrix::zeros(0, parameters),
        }
    }
}

/// One pose of a linearised problem; names as in [`PoseBlock`].
pub(super) struct LinearisedPose {
    pub row: usize,
    pub block: LinearBlock,
    pub remainder: DMatrix<f64>,
    pub pose_by_parameter: DMatrix<f64>,
    /// Derivative of the rows by the pose in units of the information of its readings, rows x 6.
    pub by_pose: DMatrix<f64>,
}

/// A problem at a solution, linearised block by block, so that many poses need no more memory than one.
pub(super) struct LinearisedProblem<'a> {
    problem: &'a Problem<'a>,
    solution: &'a Solution,
    at: Evaluated<'a, f64>,
}

impl<'a> LinearisedProblem<'a> {
    pub fn new(problem: &'a Problem<'a>, solution: &'a Solution) -> Self {
        Self {
            problem,
            solution,
            at: Evaluated::at((), problem, solution, Division::default()),
        }
    }

    /// Number of poses besides the home pose.
    pub fn pose_count(&self) -> usize {
        self.at.poses.len()
    }

    pub fn pose(&mut self, index: usize) -> LinearisedPose {
        // The first evaluation finds the tensions at which the second one linearises.
        let (poses, index) = self.at.poses.part_with(index);
        poses.equations_at(index);
        poses.equations_at(index);
        let row = poses.rows()[index];
        let layout = poses.layout.clone();
        let equations = poses.equations();
        let mut elimination = Elimination::new(&layout, 0.0);
        elimination.eliminate(equations, &layout, 0.0);
        let present: Vec<usize> = (0..layout.rows)
            .filter(|r| equations.present[*r] > 0.0)
            .collect();
        let mut basis = DMatrix::zeros(present.len(), 6);
        let mut design = DMatrix::zeros(present.len(), self.solution.parameters.len());
        let mut gradient = vec![0.0; layout.columns];
        for (k, r) in present.iter().enumerate() {
            let y = elimination.half_solve(equations.by_pose[*r]);
            basis.row_mut(k).copy_from_slice(&y);
            elimination.remaining_gradient(equations, &layout, *r, y, &mut gradient);
            let mapped = self.at.map.map_row(&self.at.home, &gradient);
            design.row_mut(k).copy_from_slice(&mapped);
        }
        let whitened = DVector::from_iterator(
            present.len(),
            present.iter().map(|r| equations.residual[*r]),
        );
        let (rows, noise) = noise_of(self.problem, poses, (row, &present));
        let by_pose = &noise * &basis;
        let remainder = &noise - &by_pose * basis.transpose();
        LinearisedPose {
            row,
            block: LinearBlock {
                rows,
                residual: &remainder * whitened,
                design: &noise * design,
            },
            remainder,
            by_pose,
            pose_by_parameter: self.pose_by_parameter(&elimination),
        }
    }

    fn pose_by_parameter(&self, elimination: &Elimination<f64>) -> DMatrix<f64> {
        let mut by_column = DMatrix::zeros(6, elimination.columns.len());
        for (k, y) in elimination.columns.iter().enumerate() {
            let step = Elimination::pose_step(&elimination.factor, [0.0; 6], *y);
            by_column.column_mut(k).copy_from_slice(&step);
        }
        let mut mapped = DMatrix::zeros(6, self.solution.parameters.len());
        for k in 0..6 {
            let row: Vec<f64> = by_column.row(k).iter().copied().collect();
            let row = self.at.map.map_row(&self.at.home, &row);
            mapped.row_mut(k).copy_from_slice(&row);
        }
        mapped
    }

    /// Derivative of the position that a controller reaches at pose `index` with respect to the parameters that it has, 3 x
    /// parameters (m per unit of the parameter); `None` where a length was not read or the pose is not estimated.
    ///
    /// The controller commands the length that it expects at the pose. With its length row `r(x; p)`, which is 0 for the true
    /// parameters where the platform comes to rest, parameters that are off by `dp` move the platform by `dx = J^+ (dr/dp) dp`,
    /// `J = dr/dx`; contradicting lengths are met in the least-squares sense. Tensions are taken as known.
    pub fn position_by_parameter(&mut self, index: usize) -> Option<DMatrix<f64>> {
        let (poses, index) = self.at.poses.part_with(index);
        let layout = poses.layout.clone();
        let equations = &*poses.equations_at(index);
        let is_read = |cable: usize| equations.present[cable] > 0.0;
        if self.problem.poses != Poses::Estimated || !(0..layout.cables).all(is_read) {
            return None;
        }
        let freedom = self.problem.dataset.robot.platform.freedom();
        let coordinates = freedom.coordinates();
        // The derivative of a row by the length at home is minus its weight, which is taken out again.
        let scale = |cable: usize| -equations.length_by_cable[cable][3].recip();
        let by_pose = DMatrix::from_fn(layout.cables, coordinates.len(), |cable, k| {
            scale(cable) * equations.by_pose[cable][coordinates[k].index()]
        });
        let mut by_parameter = DMatrix::zeros(layout.cables, self.solution.parameters.len());
        let nothing = Elimination::new(&layout, 0.0);
        let mut gradient = vec![0.0; layout.columns];
        for cable in 0..layout.cables {
            nothing.remaining_gradient(equations, &layout, cable, [0.0; 6], &mut gradient);
            let mapped = self.at.map.map_row(&self.at.home, &gradient);
            for (k, (slope, parameter)) in mapped.iter().zip(&self.solution.parameters).enumerate()
            {
                if !matches!(parameter.id, ParameterId::HomeTension { .. }) {
                    by_parameter[(cable, k)] = scale(cable) * slope;
                }
            }
        }
        position_response(by_pose, &by_parameter, freedom)
    }

    /// The readings at the home pose except the lengths and tensions, which have no rows of their own.
    pub fn home(&mut self) -> LinearBlock {
        let n = self.solution.parameters.len();
        let Some((row, evaluator)) = &mut self.at.home_evaluator else {
            return LinearBlock::empty(n);
        };
        let layout = evaluator.layout.clone();
        let present = evaluator.equations_at(0).present.clone();
        let read: Vec<usize> = (layout.cables..layout.rows)
            .filter(|r| present[*r] > 0.0)
            .collect();
        let home = &self.at.home;
        let of = |r: &usize| LinearRow {
            row: Some(*row),
            kind: RowKind::Observation(layout.kinds[*r]),
            sd: sd_of(self.problem, evaluator, layout.kinds[*r], *row),
        };
        let residual = read.iter().map(|r| home.residuals[r - layout.cables]);
        LinearBlock {
            rows: read.iter().map(of).collect(),
            residual: DVector::from_iterator(read.len(), residual),
            design: DMatrix::from_fn(read.len(), n, |i, k| {
                home.gradients[(read[i] - layout.cables) * n + k]
            }),
        }
    }

    /// The distances, with what the readings of the poses leave unknown about them; the rows are independent.
    pub fn distances(&mut self) -> LinearBlock {
        let readings = &self.problem.dataset.measurements.distances;
        let Some(distances) = self.at.distances(
            self.problem,
            (&self.solution.globals, &self.solution.parameters),
        ) else {
            return LinearBlock::empty(self.solution.parameters.len());
        };
        let row = |(index, reading): (usize, &DistanceReading)| LinearRow {
            row: Some(reading.rows[0]),
            kind: RowKind::Observation(ObservationKind::Distance(index)),
            sd: reading.sd_m,
        };
        LinearBlock {
            rows: readings.iter().enumerate().map(row).collect(),
            residual: distances.remaining,
            design: distances.design,
        }
    }

    pub fn priors(&self) -> LinearBlock {
        let parameters = &self.solution.parameters;
        let priors = Priors::evaluate(self.problem, &self.solution.globals, parameters);
        let known = parameters.iter().enumerate();
        let known: Vec<(usize, f64)> = known
            .filter_map(|(index, parameter)| Some((index, parameter.prior_sd?)))
            .collect();
        let of = |(index, sd): &(usize, f64)| LinearRow {
            row: None,
            kind: match parameters[*index].id {
                ParameterId::HomeTension { cable } if self.problem.assumes_tensions() => {
                    RowKind::AssumedTension(cable)
                }
                _ => RowKind::Prior(*index),
            },
            sd: *sd,
        };
        let mut whole = DMatrix::zeros(parameters.len(), parameters.len());
        for (row, column, value) in &priors.derivatives {
            whole[(*row, *column)] = *value;
        }
        let residuals = known.iter().map(|(index, _)| priors.residuals[*index]);
        LinearBlock {
            rows: known.iter().map(of).collect(),
            residual: DVector::from_iterator(known.len(), residuals),
            design: whole.select_rows(known.iter().map(|(index, _)| index)),
        }
    }
}

/// Estimated noise of each reading, in its standard deviations, as a linear map of the whitened rows
/// that are present.
fn noise_of(
    problem: &Problem<'_>,
    poses: &Evaluator<'_, f64>,
    (row, present): (usize, &[usize]),
) -> (Vec<LinearRow>, DMatrix<f64>) {
    let is_assumed = problem.assumes_tensions();
    let read = |kind: ObservationKind, own: usize| match kind {
        ObservationKind::Tension(cable) => {
            is_assumed || is_tension_read(problem, poses, (row, cable))
        }
        _ => present.contains(&own),
    };
    let estimates = poses.noise_estimates();
    let estimates: Vec<_> = estimates
        .iter()
        .filter(|one| read(one.kind, one.row))
        .collect();
    let of = |one: &&NoiseEstimate<f64>| LinearRow {
        row: Some(row),
        kind: match one.kind {
            ObservationKind::Tension(cable) if is_assumed => RowKind::AssumedTension(cable),
            kind => RowKind::Observation(kind),
        },
        sd: sd_of(problem, poses, one.kind, row),
    };
    let balance = poses.layout.equilibrium;
    let entry = |reading: usize, column: usize| {
        let (one, row) = (estimates[reading], present[column]);
        let shared = balance.and_then(|first| one.balance.get(row.checked_sub(first)?));
        let own = if row == one.row { one.own } else { 0.0 };
        own + shared.copied().unwrap_or(0.0)
    };
    let map = DMatrix::from_fn(estimates.len(), present.len(), entry);
    (estimates.iter().map(of).collect(), map)
}
