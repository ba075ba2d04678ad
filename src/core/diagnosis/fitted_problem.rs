//! The problem from which a diagnosis starts.

use super::budget::MOST_DIAGNOSED_ROWS;
use super::fit::Fit;
use crate::effect::{BoundEffect, measurements_as_modelled};
use crate::estimation::{EstimationError, Problem};
use crate::measurement::Dataset;
use crate::robot::{PartTolerances, Robot};

/// The robot with the tolerances that a diagnosis assumes: no machine is exact, so what is not stated is typical. The
/// deviations that a model states are estimated anew.
pub(super) fn with_assumed_tolerances(robot: &Robot) -> Robot {
    let mut robot = robot.clone();
    robot.deviations.clear();
    robot.tolerances.get_or_insert_with(PartTolerances::typical);
    robot
}

/// What a diagnosis takes of a dataset: channels as the model states them, rows of one standstill averaged, recordings in motion and
/// very many poses thinned, and the tolerances that it assumes; with the largest number of averaged rows of a standstill.
pub(super) fn independent_dataset(dataset: &Dataset) -> Result<(Dataset, usize), EstimationError> {
    let measurements = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
    let (averaged, rows) = measurements.independent(&dataset.robot, MOST_DIAGNOSED_ROWS);
    let independent = Dataset {
        robot: with_assumed_tolerances(&dataset.robot),
        measurements: averaged.into_owned(),
    };
    Ok((independent, rows))
}

/// Chi-square of the model of a dataset without a cause.
pub(super) fn chi2_without_causes(dataset: &Dataset) -> Result<f64, EstimationError> {
    let problem = problem_at_fitted_poses(dataset)?;
    Ok(Fit::new(&problem, &[])?.solution.chi2)
}

/// The problem with the effects of the model estimated, as far as readings depend on them, and evaluated at the poses of
/// its own solution.
pub(super) fn problem_at_fitted_poses(dataset: &Dataset) -> Result<Problem<'_>, EstimationError> {
    let mut problem = Problem::new(dataset)?;
    let is_free = |bound: &BoundEffect| {
        bound.effect.is_estimable() && bound.check_poses(&dataset.measurements).is_ok()
    };
    (problem.free_effects, problem.held_effects) =
        problem.held_effects.into_iter().partition(is_free);
    loop {
        match Fit::new(&problem, &[]) {
            Ok(first) => return Ok(problem.at_poses_of(&first.solution)),
            Err(EstimationError::Unobservable(id)) => {
                let is_unread = |bound: &mut BoundEffect| bound.effect.id() == id;
                let unread = problem.free_effects.extract_if(.., is_unread);
                problem.held_effects.extend(unread);
            }
            Err(error) => return Err(error),
        }
    }
}
