//! Sets of causes: whether two are the same, and whether their values are possible.

use super::candidates::{is_same_effect_and_targets, is_same_period};
use super::fit::Fit;
use super::priors::IMPOSSIBLE_FACTOR;
use super::report::Cause;
use crate::effect::Search;

/// A set of causes with its posterior.
#[derive(Debug, Clone)]
pub(super) struct RankedSet {
    pub causes: Vec<Cause>,
    pub log_posterior: f64,
}

/// Whether all parameter values of a fit are physically possible.
pub(super) fn is_physically_possible(fit: &Fit<'_>) -> bool {
    fit.solution.chi2.is_finite() && fit.causes.iter().all(has_possible_values)
}

/// Whether all parameter values of a cause are physically possible.
pub(super) fn has_possible_values(cause: &Cause) -> bool {
    let bounds = cause.instances.iter();
    let mut values = bounds.flat_map(|b| b.values.iter().zip(b.effect.parameters()));
    values.all(|(value, p)| {
        let [_, largest] = p.typical_sizes();
        let sized =
            p.discrete || (value - p.neutral).abs() < IMPOSSIBLE_FACTOR * largest.max(p.prior_sd);
        sized && *value >= p.bounds[0] && *value <= p.bounds[1]
    })
}

/// Whether two sets consist of the same causes, in any order.
pub(super) fn is_same_set(one: &[Cause], other: &[Cause]) -> bool {
    let contains = |all: &[Cause], cause: &Cause| all.iter().any(|c| is_same_cause(c, cause));
    one.len() == other.len() && one.iter().all(|cause| contains(other, cause))
}

/// Whether two causes have the same effect and targets, events the same pose, and waves about the same period.
pub(super) fn is_same_cause(one: &Cause, other: &Cause) -> bool {
    let value = |cause: &Cause, k: usize| cause.instances[0].values[k];
    is_same_effect_and_targets(one, other)
        && match one.effect().search() {
            Search::FromPose(k) | Search::AtPose(k) => value(one, k) == value(other, k),
            Search::Wave {
                period: Some(k), ..
            } => is_same_period(value(one, k), value(other, k)),
            _ => true,
        }
}
