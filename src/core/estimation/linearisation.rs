//! Linearisation of all readings at a solution, with the poses and the latent tensions eliminated.
//!
//! Every reading, equilibrium equation and prior is one row, the estimate of its noise in its own standard
//! deviations. With the poses (and tensions) `x` and the common parameters `g`, rows `r + J dx + G dg`, the
//! elimination leaves `r + A dg` with `A = M G` and `M = I - J (J^T J)^-1 J^T`. Least squares in `g` is then
//! plain linear algebra on `A` and `r` for any robot: score tests, angles between signatures and
//! cross-validation need nothing else.

use nalgebra::{DMatrix, DVector};

use super::analysis::{is_tension_read, sd_of};
use super::evaluated::Evaluated;
use super::evaluator::{Elimination, Evaluator, NoiseEstimate};
use super::observation::ObservationKind;
use super::options::Division;
use super::parameter::{Parameter, ParameterId};
use super::problem::Problem;
use super::solution::Solution;
use super::system::Priors;

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
    /// Kinds of the rows: pose by pose, then those of the home pose, then priors.
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
        Builder::new(problem, solution).build()
    }
}

struct Builder<'a> {
    problem: &'a Problem<'a>,
    solution: &'a Solution,
    at: Evaluated<'a, f64>,
    rows: Vec<LinearRow>,
    residual: Vec<f64>,
    /// Blocks of the design, stacked at the end.
    blocks: Vec<DMatrix<f64>>,
    poses: Vec<PoseBlock>,
}

impl<'a> Builder<'a> {
    fn new(problem: &'a Problem<'a>, solution: &'a Solution) -> Self {
        Self {
            problem,
            solution,
            at: Evaluated::at((), problem, solution, Division::default()),
            rows: Vec::new(),
            residual: Vec::new(),
            blocks: Vec::new(),
            poses: Vec::new(),
        }
    }

    fn build(mut self) -> Linearisation {
        for index in 0..self.at.poses.len() {
            self.add_pose(index);
        }
        self.add_home();
        self.add_priors();
        let parameters = self.solution.parameters.clone();
        let mut design = DMatrix::zeros(self.rows.len(), parameters.len());
        let mut first = 0;
        for block in &self.blocks {
            design.rows_mut(first, block.nrows()).copy_from(block);
            first += block.nrows();
        }
        Linearisation {
            parameters,
            rows: self.rows,
            residual: DVector::from_vec(self.residual),
            design,
            poses: self.poses,
        }
    }

    fn add_pose(&mut self, index: usize) {
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
        let (kinds, noise) = noise_of(self.problem, poses, (row, &present));
        let remainder = &noise - (&noise * &basis) * basis.transpose();
        let first = self.rows.len();
        self.rows.extend(kinds);
        self.residual.extend((&remainder * whitened).iter());
        self.blocks.push(&noise * design);
        self.poses.push(PoseBlock {
            row,
            rows: first..self.rows.len(),
            remainder,
            pose_by_parameter: self.pose_by_parameter(&elimination),
        });
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

    fn add_home(&mut self) {
        let Some((row, evaluator)) = &mut self.at.home_evaluator else {
            return;
        };
        let layout = evaluator.layout.clone();
        let present = evaluator.equations_at(0).present.clone();
        let n = self.solution.parameters.len();
        for r in (layout.cables..layout.rows).filter(|r| present[*r] > 0.0) {
            let index = r - layout.cables;
            let kind = layout.kinds[r];
            self.rows.push(LinearRow {
                row: Some(*row),
                kind: RowKind::Observation(kind),
                sd: sd_of(self.problem, evaluator, kind, *row),
            });
            self.residual.push(self.at.home.residuals[index]);
            let gradient = &self.at.home.gradients[index * n..(index + 1) * n];
            self.blocks.push(DMatrix::from_row_slice(1, n, gradient));
        }
    }

    fn add_priors(&mut self) {
        let parameters = &self.solution.parameters;
        let priors = Priors::evaluate(self.problem, &self.solution.globals, parameters);
        for (index, parameter) in parameters.iter().enumerate() {
            let Some(sd) = parameter.prior_sd else {
                continue;
            };
            let mut block = DMatrix::zeros(1, parameters.len());
            for (row, column, value) in &priors.derivatives {
                if *row == index {
                    block[(0, *column)] = *value;
                }
            }
            self.rows.push(LinearRow {
                row: None,
                kind: match parameter.id {
                    ParameterId::HomeTension { cable } if self.problem.assumes_tensions() => {
                        RowKind::AssumedTension(cable)
                    }
                    _ => RowKind::Prior(index),
                },
                sd,
            });
            self.residual.push(priors.residuals[index]);
            self.blocks.push(block);
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
