//! A model fitted to the data: the nominal one, extended by causes.

use super::report::Cause;
use crate::estimation::{
    Control, EstimationError, Options, ParameterId, Problem, Progress, Solution, solve,
};

/// Steps tried after which a fit that is still worse than it must become is given up: one that gets there needs
/// half as many.
const PATIENCE: usize = 15;
/// Most steps of a fit with causes: those that creep on are no explanation.
const MOST_STEPS: usize = 40;

/// A problem with its solution.
#[derive(Debug, Clone)]
pub(super) struct Fit<'a> {
    pub problem: Problem<'a>,
    pub solution: Solution,
    /// The causes with the values fitted.
    pub causes: Vec<Cause>,
}

impl<'a> Fit<'a> {
    /// Fits the problem `base` with `causes` freed, starting from their values. What does not become better than
    /// without them is not fitted to the end.
    pub fn new(base: &Problem<'a>, causes: &[Cause]) -> Result<Self, EstimationError> {
        let known = base.known.as_ref().filter(|_| !causes.is_empty());
        let bound = known.map_or(f64::INFINITY, |known| known.chi2);
        Self::below((bound, PATIENCE), base, causes)
    }

    /// The same to the end: where nothing explains the readings yet, the way may be long.
    pub fn to_the_end(base: &Problem<'a>, causes: &[Cause]) -> Result<Self, EstimationError> {
        Self::below((f64::INFINITY, usize::MAX), base, causes)
    }

    /// The same, given up where chi-square is not below a bound after so many steps.
    pub fn below(
        (bound, patience): (f64, usize),
        base: &Problem<'a>,
        causes: &[Cause],
    ) -> Result<Self, EstimationError> {
        let mut problem = base.clone();
        problem.free_effects = causes
            .iter()
            .flat_map(|cause| cause.instances.iter().cloned())
            .collect();
        let mut tried = 0;
        let watch = &mut |progress: &Progress| {
            tried += 1;
            if tried > patience && progress.loss > bound {
                Control::Cancel
            } else {
                Control::Continue
            }
        };
        let mut options = Options::default();
        if bound.is_finite() {
            options.max_iterations = MOST_STEPS;
        }
        let solution = solve(&problem, &options, watch)?;
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
