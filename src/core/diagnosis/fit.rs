//! A fit of the model, extended by candidate causes.

use std::cell::OnceCell;
use std::rc::Rc;

use super::report::Cause;
use crate::estimation::{
    Control, EstimationError, Linearisation, Options, ParameterId, Problem, Progress, Solution,
    solve,
};

/// Number of steps after which a fit that is still worse than required is abandoned; successful fits need half as many.
const PATIENCE: usize = 15;
/// Maximum number of steps of a fit with causes; one that converges more slowly explains nothing.
const MAX_STEPS: usize = 40;

/// A problem with its solution.
#[derive(Debug, Clone)]
pub(super) struct Fit<'a> {
    pub problem: Problem<'a>,
    pub solution: Solution,
    /// The causes with their fitted values.
    pub causes: Vec<Cause>,
    linearisation: OnceCell<Rc<Linearisation>>,
}

impl<'a> Fit<'a> {
    /// Fits the problem `base` with the parameters of `causes` freed, starting from their values. The fit is abandoned
    /// early if it does not improve on the one without causes.
    pub fn new(base: &Problem<'a>, causes: &[Cause]) -> Result<Self, EstimationError> {
        let known = base.known.as_ref().filter(|_| !causes.is_empty());
        let bound = known.map_or(f64::INFINITY, |known| known.chi2);
        Self::with_early_stop((bound, PATIENCE), base, causes)
    }

    /// Fits, but stops if chi-square is not below a bound after so many steps.
    pub fn with_early_stop(
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
            options.max_iterations = MAX_STEPS;
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
            linearisation: OnceCell::new(),
        })
    }

    /// The problem linearised at the solution.
    pub fn linearisation(&self) -> Rc<Linearisation> {
        let new = || Rc::new(Linearisation::new(&self.problem, &self.solution));
        Rc::clone(self.linearisation.get_or_init(new))
    }

    /// Number of parameters of all causes.
    pub fn parameters(&self) -> usize {
        (0..self.causes.len())
            .map(|cause| self.parameters_of(cause).len())
            .sum()
    }

    /// Indices of the parameters of one cause in the solution.
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
