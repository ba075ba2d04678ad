//! A model fitted to the data: the nominal one, extended by causes.

use super::report::Cause;
use crate::effect::BoundEffect;
use crate::estimation::{Control, EstimationError, Options, ParameterId, Problem, Solution, solve};

/// A problem with its solution.
#[derive(Debug, Clone)]
pub(super) struct Fit<'a> {
    pub problem: Problem<'a>,
    pub solution: Solution,
    /// The causes with the values fitted.
    pub causes: Vec<Cause>,
}

impl<'a> Fit<'a> {
    /// Fits the problem `base` with `causes` freed, starting from their values.
    pub fn new(base: &Problem<'a>, causes: &[Cause]) -> Result<Self, EstimationError> {
        let mut problem = base.clone();
        problem.free_effects = causes
            .iter()
            .flat_map(|cause| cause.instances.iter().cloned())
            .collect();
        let quiet = &mut |_: &_| Control::Continue;
        let solution = solve(&problem, &Options::default(), quiet)?;
        let mut fitted = solution.globals.effects[problem.held_effects.len()..].iter();
        let causes = causes
            .iter()
            .map(|cause| Cause {
                instances: fitted
                    .by_ref()
                    .take(cause.instances.len())
                    .cloned()
                    .collect(),
            })
            .collect();
        Ok(Self {
            problem,
            solution,
            causes,
        })
    }

    /// The parameters of one cause: index in the solution, prior standard deviation.
    pub fn parameters_of(&self, cause: usize) -> Vec<usize> {
        let before: usize = self.causes[..cause].iter().map(|c| c.instances.len()).sum();
        let own = before..before + self.causes[cause].instances.len();
        let is_own = |id: &ParameterId| match id {
            ParameterId::Effect { effect, .. } => own.contains(effect),
            _ => false,
        };
        let parameters = self.solution.parameters.iter();
        let numbered = parameters.enumerate().filter(|(_, p)| is_own(&p.id));
        numbered.map(|(k, _)| k).collect()
    }

    /// How much the freedom of a cause is worth: the logarithm of the ratio of prior to posterior volume,
    /// twice. `None` where the data leave parameters undetermined.
    pub fn freedom_of(&self, cause: usize) -> Option<f64> {
        let own = self.parameters_of(cause);
        let covariance = self.solution.covariance.as_ref()?;
        let sd = |k: usize| self.solution.parameters[k].prior_sd.unwrap_or(1.0);
        let scaled = nalgebra::DMatrix::from_fn(own.len(), own.len(), |i, k| {
            covariance[(own[i], own[k])] / (sd(own[i]) * sd(own[k]))
        });
        let factor = scaled.cholesky()?;
        let logarithms = factor.l_dirty().diagonal().map(f64::ln);
        Some((-2.0 * logarithms.sum()).max(0.0))
    }
}

/// All instances of causes.
pub(super) fn instances(causes: &[Cause]) -> Vec<BoundEffect> {
    causes
        .iter()
        .flat_map(|c| c.instances.iter().cloned())
        .collect()
}
