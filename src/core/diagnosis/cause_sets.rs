//! Sets of causes, and whether their values are possible.

use super::fit::Fit;
use super::priors::IMPOSSIBLE_FACTOR;
use super::report::{Cause, CauseSet};
use crate::robot::Robot;
use crate::statistics::log_sum;

/// A set of causes with its posterior.
#[derive(Debug, Clone)]
pub(super) struct RankedSet {
    pub causes: Vec<Cause>,
    pub log_posterior: f64,
}

/// Probabilities of ranked sets, most probable first; empty if no set makes the readings possible.
pub(super) fn set_probabilities(ranking: &[RankedSet]) -> Vec<CauseSet> {
    let total = log_sum(ranking.iter().map(|set| set.log_posterior));
    if !total.is_finite() {
        return Vec::new();
    }
    let cause_set = |set: &RankedSet| CauseSet {
        causes: set.causes.clone(),
        probability: (set.log_posterior - total).exp(),
    };
    let mut sets: Vec<CauseSet> = ranking.iter().map(cause_set).collect();
    sets.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    sets
}

/// Whether all parameter values of a fit are physically possible.
pub(super) fn is_physically_possible(fit: &Fit<'_>) -> bool {
    let robot = &fit.problem.dataset.robot;
    let are_possible = |cause: &Cause| has_possible_values(cause, robot);
    fit.solution.chi2.is_finite() && fit.causes.iter().all(are_possible)
}

/// Whether all parameter values of a cause are physically possible.
pub(super) fn has_possible_values(cause: &Cause, robot: &Robot) -> bool {
    let bounds = cause.instances.iter();
    let mut values = bounds.flat_map(|b| b.values.iter().zip(b.effect.parameters()));
    values.all(|(value, p)| {
        let limit = IMPOSSIBLE_FACTOR * p.largest_in(robot).max(p.prior_sd_in(robot));
        let sized = p.discrete || (value - p.neutral).abs() < limit;
        sized && *value >= p.bounds[0] && *value <= p.bounds[1]
    })
}
