//! Deviations of the parts within their tolerances, which are in the model beside every set of causes.
//!
//! The deviation of each part has the prior standard deviation `kappa t` with its tolerance `t` and a factor `kappa` common to
//! all parts, which the readings determine. Its derivative is one more column that is eliminated from all conditions, so that a
//! cause is a deviation beyond the tolerances: its own column enters a second time with the variance of a fault.
//!
//! Of the hundred or so columns only combinations matter that affect the readings. With the columns `D` of tolerances and the
//! projection `P` of the parameters that are always estimated, the eigenvectors of `D^T P D` are combinations with independent
//! priors of the same variance; those of small eigenvalues are left out.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::budget::MIN_VISIBLE_VARIANCE;
use super::conditions::{Conditions, columns_of, is_fixed};
use super::hyperparameters::LinearProblem;
use crate::effect::{PartDeviation, part_deviations};
use crate::estimation::{Linearisation, ParameterId, Problem, RowKind, Solution};

/// Combinations of the deviations at a fit.
#[derive(Debug, Clone)]
pub(super) struct DeviationColumns {
    /// Derivatives of the rows of a linearisation by the combinations, whose prior variance is `kappa^2`.
    rows: DMatrix<f64>,
    /// The deviations that readings can show.
    pub visible: Vec<PartDeviation>,
}

impl DeviationColumns {
    /// The combinations for the tolerances that the robot states; none if it states none.
    pub fn new(problem: &Problem<'_>, solution: &Solution, model_effects: usize) -> Self {
        let robot = &problem.dataset.robot;
        let tolerances = robot.tolerances.as_ref();
        let deviations = tolerances.map_or_else(Vec::new, |t| part_deviations(robot, t));
        if deviations.is_empty() {
            return Self::none();
        }
        let (linear, columns) = linearised(problem, solution, &deviations);
        let is_common = |id: &ParameterId| is_fixed(id, model_effects);
        let conditions = Conditions::new(&linear, is_common);
        let fixed = columns_of(&linear, is_common);
        let of_conditions = conditions.project_rows(&columns);
        let without = LinearProblem {
            residual: DVector::zeros(conditions.count),
            fixed: conditions.project_rows(&fixed),
            deviations: DMatrix::zeros(conditions.count, 0),
            shapes: Vec::new(),
            conditions,
        };
        let none = DMatrix::zeros(without.conditions.count, 0);
        let base = without.reduced(&without.described(0), &none);
        let eliminated = &base.eliminated * &of_conditions;
        let information = of_conditions.tr_mul(&of_conditions) - eliminated.tr_mul(&eliminated);
        let mut is_visible = vec![false; deviations.len()];
        let of_deviations = linear.parameters.iter().filter_map(|p| match p.id {
            ParameterId::Deviation { deviation, .. } => Some(deviation),
            _ => None,
        });
        for (deviation, variance) in of_deviations.zip(&information.diagonal()) {
            is_visible[deviation] |= *variance > MIN_VISIBLE_VARIANCE;
        }
        let visible = deviations.into_iter().zip(is_visible);
        let visible = visible.filter_map(|(deviation, is_visible)| is_visible.then_some(deviation));
        let eigen = SymmetricEigen::new(information);
        let kept: Vec<usize> = (0..eigen.eigenvalues.len())
            .filter(|k| eigen.eigenvalues[*k] > MIN_VISIBLE_VARIANCE)
            .collect();
        Self {
            rows: columns * eigen.eigenvectors.select_columns(&kept),
            visible: visible.collect(),
        }
    }

    /// No combinations, as of exact parts.
    pub fn none() -> Self {
        Self {
            rows: DMatrix::zeros(0, 0),
            visible: Vec::new(),
        }
    }

    /// The combinations as conditions of a linearisation, which may have other priors than the one that they come from.
    pub fn conditions(&self, linear: &Linearisation, conditions: &Conditions) -> DMatrix<f64> {
        let mut rows = DMatrix::zeros(linear.rows.len(), self.rows.ncols());
        let shared = rows.nrows().min(self.rows.nrows());
        rows.rows_mut(0, shared)
            .copy_from(&self.rows.rows(0, shared));
        conditions.project_rows(&rows)
    }
}

/// A linearisation of a fit's problem with all deviations, at the values that it has estimated, and their columns in units of the
/// tolerances.
pub(super) fn linearised(
    problem: &Problem<'_>,
    solution: &Solution,
    deviations: &[PartDeviation],
) -> (Linearisation, DMatrix<f64>) {
    let mut problem = problem.clone();
    let mut solution = solution.clone();
    let estimated = &solution.globals.deviations;
    let present = deviations.iter().map(|deviation| {
        let estimated = estimated
            .iter()
            .find(|estimated| deviation.is_estimated_by(estimated));
        estimated.unwrap_or(&deviation.bound).clone()
    });
    solution.globals.deviations = present.collect();
    problem.held_deviations.clear();
    problem.deviations = deviations.to_vec();
    solution.parameters = problem.parameters();
    let linear = Linearisation::new(&problem, &solution);
    let mut columns = columns_of(&linear, |id| matches!(id, ParameterId::Deviation { .. }));
    let of_deviations = linear.parameters.iter();
    let of_deviations = of_deviations.filter(|p| matches!(p.id, ParameterId::Deviation { .. }));
    for (mut column, parameter) in columns.column_iter_mut().zip(of_deviations) {
        column *= parameter.prior_sd.unwrap_or(0.0);
    }
    for (row, linear_row) in linear.rows.iter().enumerate() {
        if is_prior_of_deviation(linear_row.kind, &linear) {
            columns.row_mut(row).fill(0.0);
        }
    }
    (linear, columns)
}

/// Whether a row is the prior of a deviation, which the combinations have in their own variance.
fn is_prior_of_deviation(kind: RowKind, linear: &Linearisation) -> bool {
    match kind {
        RowKind::Prior(k) => matches!(linear.parameters[k].id, ParameterId::Deviation { .. }),
        RowKind::Observation(_) | RowKind::AssumedTension(_) => false,
    }
}

/// Change of the rows of a fit by its estimated deviations, to first order.
pub(super) fn explained_by_deviations(
    problem: &Problem<'_>,
    solution: &Solution,
    linear: &Linearisation,
) -> DVector<f64> {
    let mut explained = DVector::zeros(linear.rows.len());
    for (column, parameter) in linear.design.column_iter().zip(&linear.parameters) {
        if let ParameterId::Deviation {
            deviation,
            parameter,
        } = parameter.id
        {
            let held = problem.held_deviations.len();
            let value = solution.globals.deviations[held + deviation].values[parameter];
            let centre = problem.deviations[deviation].bound.values[parameter];
            explained.axpy(value - centre, &column, 1.0);
        }
    }
    explained
}
