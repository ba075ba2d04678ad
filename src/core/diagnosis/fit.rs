//! A model fitted to the data: the nominal one, extended by causes.

use super::report::Cause;
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

    /// Number of parameters of all causes.
    pub fn parameters(&self) -> usize {
        (0..self.causes.len())
            .map(|cause| self.parameters_of(cause).len())
            .sum()
    }

    /// The parameters of one cause: indices in the solution.
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
}
