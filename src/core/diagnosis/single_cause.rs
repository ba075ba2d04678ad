//! One effect without rivals: the target, pose or period and size at which it would explain the readings best.

use super::evidence::{Member, best_scale};
use super::fit::Fit;
use super::fitted_problem::{problem_at_fitted_poses, with_assumed_tolerances};
use super::linear_fit::LinearFit;
use super::priors::AS_STATED;
use super::relations::is_same_effect_and_targets;
use super::report::Cause;
use crate::effect::{Effect, measurements_as_modelled};
use crate::estimation::EstimationError;
use crate::measurement::Dataset;

/// An effect on one of its targets.
#[derive(Debug, Clone)]
pub struct SingleCause {
    /// The effect with the values that the linearised readings have for it; an event at its most probable pose, a wave with
    /// its most probable period.
    pub cause: Cause,
    /// Log posterior odds against no cause at all, at that pose or period and the most probable scale of its size.
    pub log_odds: f64,
}

/// An effect on each of its targets, the most probable target first; none where no reading depends on it. Other causes are
/// absent and noise is as described, so that the order is a first look and no diagnosis.
///
/// # Errors
/// If the readings cannot be used with the robot.
pub fn single_causes(
    dataset: &Dataset,
    effect: &'static Effect,
) -> Result<Vec<SingleCause>, EstimationError> {
    let measurements = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
    let dataset = Dataset {
        robot: with_assumed_tolerances(&dataset.robot),
        measurements: measurements.into_owned(),
    };
    let problem = problem_at_fitted_poses(&dataset)?;
    let fit = Fit::new(&problem, &[])?;
    let linear_fit = LinearFit::new(&fit, true);
    let mut gram = linear_fit.gram(&linear_fit.linear.described(AS_STATED));
    let mut ranked: Vec<(Member, f64)> = Vec::new();
    for index in 0..gram.candidates.len() {
        let candidate = &gram.candidates[index];
        if !std::ptr::eq(candidate.effect(), effect) || candidate.is_family() {
            continue;
        }
        let score = gram.scores[index].in_prior_units(candidate);
        let Some((evidence, scale)) = best_scale(candidate, &score, f64::NEG_INFINITY) else {
            continue;
        };
        let log_odds = evidence + candidate.log_odds;
        let is_there = |((entry, _), _): &&mut (Member, f64)| {
            is_same_effect_and_targets(&gram.candidates[*entry].cause, &candidate.cause)
        };
        match ranked.iter_mut().find(is_there) {
            Some(entry) if entry.1 < log_odds => *entry = ((index, scale), log_odds),
            Some(_) => {}
            None => ranked.push(((index, scale), log_odds)),
        }
    }
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    let cause = |(member, log_odds)| {
        let cause = linear_fit.causes_of(&mut gram, &[member]).pop()?;
        Some(SingleCause { cause, log_odds })
    };
    Ok(ranked.into_iter().filter_map(cause).collect())
}
