//! Information of planned poses on the common parameters, before any measurement or solution.
//!
//! Information is additive: `I = I_0 + sum R_k^T R_k`, where `I_0` is that of the priors and the home pose and `R_k` are
//! the whitened rows of pose `k` that remain once its coordinates (and tensions) are eliminated. With the
//! orthonormalised derivative `Q` of the rows by the pose and the orthogonal complement `Z` of its range, `R = Z^T G` for the
//! derivative `G` by the common parameters: as many rows as the pose has redundant readings.

use nalgebra::DMatrix;

use super::evaluated::Evaluated;
use super::evaluator::{Elimination, Sums};
use super::globals::Globals;
use super::options::Division;
use super::parameter::{Parameter, ParameterId};
use super::problem::Problem;
use super::system::{Priors, System, home_information};
use crate::geometry::Pose;

/// Threshold on the norm of a column of `Q`; a coordinate that the readings leave undetermined stays below.
const DETERMINED: f64 = 0.5;

/// Information on the common parameters, pose by pose.
#[derive(Debug, Clone)]
pub struct ExpectedInformation {
    /// The parameters, in the order of the columns.
    pub parameters: Vec<Parameter>,
    /// `I_0`: information of the priors and of the readings at the home pose; parameters x parameters.
    pub common: DMatrix<f64>,
    /// Part of `I_0` due to the prior of the home pose; parameters x parameters.
    pub home: DMatrix<f64>,
    /// `R_k` of each pose, in order; rows x parameters, in standard deviations.
    pub poses: Vec<DMatrix<f64>>,
}

impl ExpectedInformation {
    /// Computes the information at the nominal values of `problem` with the platform at `poses`, one for each of its rows
    /// except the home row. Readings are those predicted there, so that residuals are zero.
    ///
    /// # Panics
    /// If the number of poses differs from that of the rows.
    #[must_use]
    pub fn new(problem: &Problem<'_>, poses: &[Pose]) -> Self {
        let globals = Globals::nominal(problem);
        let parameters = problem.parameters();
        let rows = problem.pose_rows();
        assert_eq!(rows.len(), poses.len(), "one pose per row");
        let division = Division::default();
        let poses_of_rows = (rows.as_slice(), poses);
        let mut at =
            Evaluated::<f64>::new((), problem, &globals, &parameters, poses_of_rows, division);
        let priors = Priors::evaluate(problem, &globals, &parameters);
        let nothing = Sums::<f64>::new((), at.poses.layout());
        Self {
            common: System::build(&nothing, &at.map, &at.home, &priors).information,
            home: home_information(problem, &parameters),
            poses: (0..poses.len())
                .map(|index| remaining_rows(&mut at, index))
                .collect(),
            parameters,
        }
    }

    /// Indices of the parameters that are deviations of parts within their tolerances.
    pub(crate) fn deviations(&self) -> Vec<usize> {
        let is_deviation =
            |k: &usize| matches!(self.parameters[*k].id, ParameterId::Deviation { .. });
        (0..self.parameters.len()).filter(is_deviation).collect()
    }

    /// The information on some parameters, all others known.
    pub(crate) fn on(&self, parameters: &[usize]) -> Self {
        let block = |all: &DMatrix<f64>| all.select_rows(parameters).select_columns(parameters);
        let poses = self.poses.iter();
        Self {
            parameters: parameters
                .iter()
                .map(|k| self.parameters[*k].clone())
                .collect(),
            common: block(&self.common),
            home: block(&self.home),
            poses: poses.map(|rows| rows.select_columns(parameters)).collect(),
        }
    }

    /// Information of the picked poses and of `I_0` together, parameters x parameters.
    #[must_use]
    pub fn of(&self, picked: impl IntoIterator<Item = usize>) -> DMatrix<f64> {
        let mut sum = self.common.clone();
        self.add(picked, &mut sum);
        sum
    }

    /// Adds the information of the picked poses to `sum`.
    pub(crate) fn add(&self, picked: impl IntoIterator<Item = usize>, sum: &mut DMatrix<f64>) {
        for index in picked {
            let rows = &self.poses[index];
            // A transposed copy lets the product be computed in blocks, which matters for dozens of cables.
            sum.gemm(1.0, &rows.transpose(), rows, 1.0);
        }
    }
}

/// Derivatives of expected distances by the common parameters, with the poses eliminated.
#[derive(Debug, Clone)]
pub struct ExpectedDistances {
    /// Derivatives; distances x parameters, in standard deviations.
    pub rows: DMatrix<f64>,
    /// Covariance of the distances with known parameters: that of their readings and of the poses that they connect.
    pub covariance: DMatrix<f64>,
}

impl ExpectedDistances {
    /// Evaluates the distances of a problem at its nominal values, as [`ExpectedInformation::new`] does its poses; `None` if it
    /// has none.
    #[must_use]
    pub fn new(problem: &Problem<'_>, poses: &[Pose]) -> Option<Self> {
        let globals = Globals::nominal(problem);
        let parameters = problem.parameters();
        let rows = problem.pose_rows();
        let poses = (rows.as_slice(), poses);
        let division = Division::default();
        let mut at = Evaluated::<f64>::new((), problem, &globals, &parameters, poses, division);
        let (rows, covariance) = at.distances(problem, (&globals, &parameters))?.coupled();
        Some(Self { rows, covariance })
    }
}

fn remaining_rows(at: &mut Evaluated<'_, f64>, index: usize) -> DMatrix<f64> {
    let layout = at.poses.layout().clone();
    let (poses, index) = at.poses.part_with(index);
    let equations = poses.equations_at(index);
    let mut elimination = Elimination::new(&layout, 0.0);
    elimination.eliminate(equations, &layout, 0.0);
    let measured: Vec<usize> = (0..layout.rows)
        .filter(|r| equations.present[*r] > 0.0)
        .collect();
    let mut basis = DMatrix::zeros(measured.len(), 6);
    let mut rows: Option<DMatrix<f64>> = None;
    let mut gradient = vec![0.0; layout.columns];
    for (k, r) in measured.iter().enumerate() {
        let y = elimination.half_solve(equations.by_pose[*r]);
        basis.row_mut(k).copy_from_slice(&y);
        elimination.remaining_gradient(equations, &layout, *r, y, &mut gradient);
        let mapped = at.map.map_row(&at.home, &gradient);
        let rows = rows.get_or_insert_with(|| DMatrix::zeros(measured.len(), mapped.len()));
        rows.row_mut(k).copy_from_slice(&mapped);
    }
    let Some(mut rows) = rows else {
        return DMatrix::zeros(0, 0);
    };
    let moving: Vec<_> = (basis.column_iter())
        .filter(|column| column.norm() > DETERMINED)
        .collect();
    if moving.is_empty() || moving.len() >= measured.len() {
        return rows;
    }
    let taken = moving.len();
    let turn = DMatrix::from_columns(&moving).qr();
    turn.q_tr_mul(&mut rows);
    rows.rows(taken, measured.len() - taken).into_owned()
}
