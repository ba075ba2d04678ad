//! The problem from which a diagnosis starts.

use super::budget::{MIN_REDUNDANCY_OF_NOISE, MOST_DIAGNOSED_ROWS};
use super::fit::Fit;
use super::report::{Cause, Quantity};
use super::residual_space::ResidualSpace;
use crate::effect::{BoundEffect, measurements_as_modelled};
use crate::estimation::{EstimationError, Problem};
use crate::measurement::Dataset;
use crate::robot::{PartTolerances, PerAxis, Robot};
use crate::statistics::chi_square_quantile;

/// The robot with the tolerances that a diagnosis assumes: no machine is exact, so unstated tolerances are the typical ones.
/// The deviations that a model states are estimated anew.
pub(super) fn with_assumed_tolerances(robot: &Robot) -> Robot {
    let mut robot = robot.clone();
    robot.deviations.clear();
    robot.tolerances.get_or_insert_with(PartTolerances::typical);
    robot
}

/// The dataset as a diagnosis uses it: channels as the model states them, rows of one standstill averaged, recordings in motion
/// and very many poses thinned, and tolerances assumed where none are stated. Also returns the largest number of rows averaged
/// at a standstill.
pub(super) fn independent_dataset(dataset: &Dataset) -> Result<(Dataset, usize), EstimationError> {
    let measurements = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
    let (averaged, rows) = measurements.independent(&dataset.robot, MOST_DIAGNOSED_ROWS);
    let independent = Dataset {
        robot: with_assumed_tolerances(&dataset.robot),
        measurements: averaged.into_owned(),
    };
    Ok((independent, rows))
}

/// Chi-square of the model of a dataset with some causes, if parts deviate by their tolerances times a factor.
pub(super) fn chi2_with(
    dataset: &Dataset,
    causes: &[Cause],
    factor: f64,
) -> Result<f64, EstimationError> {
    let problem = problem_at_fitted_poses(dataset)?;
    let mut fit = Fit::new(&problem, causes)?;
    if factor > 0.0 {
        fit = Fit::new(&fit.problem_with_deviations(factor), &fit.causes)?;
    }
    Ok(fit.solution.chi2)
}

/// Variance of the lengths in that stated, of the middle half of them: a few wrong ones do not change it. Parts deviate by their
/// tolerances times a factor.
pub(super) fn usual_variance(dataset: &Dataset, factor: f64) -> Result<f64, EstimationError> {
    let problem = problem_at_fitted_poses(dataset)?;
    let mut fit = Fit::new(&problem, &[])?;
    if factor > 0.0 {
        fit = Fit::new(&fit.problem_with_deviations(factor), &[])?;
    }
    let space = ResidualSpace::new(&fit.linearisation());
    let redundancy = space.redundancy();
    let is_read = |k: &usize| {
        space.readings[*k].is_some_and(|id| id.quantity == Quantity::Length)
            && redundancy[*k] > MIN_REDUNDANCY_OF_NOISE
    };
    let rows = (0..space.rows()).filter(is_read);
    let mut squares: Vec<f64> = rows
        .map(|k| space.residual[k].powi(2) / redundancy[k])
        .collect();
    squares.sort_by(f64::total_cmp);
    let middle = squares.get(squares.len() / 2);
    let of_noise = chi_square_quantile(0.5, 1.0);
    Ok((middle.zip(of_noise)).map_or(1.0, |(middle, of_noise)| (middle / of_noise).max(1.0)))
}

/// A dataset whose description states a multiple of the variance of lengths and positions.
pub(super) fn with_variance(dataset: &Dataset, variance: f64) -> Dataset {
    let mut noisier = dataset.clone();
    let factor = variance.sqrt();
    for cable in &mut noisier.robot.cables {
        cable.winch.length_sd_m *= factor;
    }
    if let Some(laser) = &mut noisier.robot.laser {
        laser.sd_m *= factor;
    }
    if let Some(tracker) = &mut noisier.robot.tracker {
        let each = tracker.position_sd_m.each();
        tracker.position_sd_m = PerAxis::Each(each.map(|sd| sd * factor));
    }
    for sds in &mut noisier.measurements.tracked_position_sd_m {
        sds.iter_mut().for_each(|sd| *sd *= factor);
    }
    noisier
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
