//! Sets of causes, and whether their values are possible.

use super::fit::Fit;
use super::priors::IMPOSSIBLE_FACTOR;
use super::report::Cause;

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
