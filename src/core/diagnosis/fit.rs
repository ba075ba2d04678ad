//! A fit of the model, extended by candidate causes.

use std::cell::OnceCell;
use std::ops::Range;
use std::rc::Rc;

use super::budget::{MAX_STEPS_WITH_CAUSES, MORE_THAN_NOISE, MOST_LEFT, PATIENCE};
use super::deviation_columns::DeviationColumns;
use super::priors::{AS_STATED, FACTORS, LARGEST_DEVIATION};
use super::report::Cause;
use crate::estimation::{
    Control, EstimationError, Linearisation, Options, ParameterId, Problem, Progress, Solution,
    solve,
};

/// A problem with its solution.
#[derive(Debug, Clone)]
pub(super) struct Fit<'a> {
    pub problem: Problem<'a>,
    pub solution: Solution,
    /// The causes with their fitted values.
    pub causes: Vec<Cause>,
    /// The problem without causes.
    base: Problem<'a>,
    linearisation: OnceCell<Rc<Linearisation>>,
    deviation_columns: OnceCell<Rc<DeviationColumns>>,
}

impl<'a> Fit<'a> {
    /// Fits the problem `base`, whose free effects are those of the model, with the parameters of `causes` freed, too,
    /// starting from their values. The fit is abandoned early if it does not improve on the one without causes.
    pub fn new(base: &Problem<'a>, causes: &[Cause]) -> Result<Self, EstimationError> {
        let of_model = base.held_effects.len() + base.free_effects.len();
        let start = base.known.as_ref().filter(|start| {
            // A solution with causes is a start only.
            !causes.is_empty() && start.globals.effects.len() == of_model
        });
        let bound = start.map_or(f64::INFINITY, |start| start.chi2);
        Self::with_early_stop((bound, PATIENCE), base, causes)
    }

    /// Fits, but stops if chi-square is not below a bound after so many steps.
    pub fn with_early_stop(
        (bound, patience): (f64, usize),
        base: &Problem<'a>,
        causes: &[Cause],
    ) -> Result<Self, EstimationError> {
        let mut problem = base.clone();
        let effects = causes.iter().flat_map(|cause| cause.instances.iter());
        problem.free_effects.extend(effects.cloned());
        problem.remove_covered_deviations();
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
            options.max_iterations = MAX_STEPS_WITH_CAUSES;
        }
        let solution = solve(&problem, &options, watch)?;
        let of_model = problem.held_effects.len() + base.free_effects.len();
        let mut fitted = solution.globals.effects[of_model..].iter();
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
            base: base.clone(),
            linearisation: OnceCell::new(),
            deviation_columns: OnceCell::new(),
        })
    }

    /// Number of effects of the model. They are estimated in every fit and come before those of the causes.
    pub fn model_effects(&self) -> usize {
        self.base.free_effects.len()
    }

    /// The problem without causes.
    pub fn base(&self) -> &Problem<'a> {
        &self.base
    }

    /// The problem without causes, with the deviations of the parts estimated, whose priors are the tolerances times a factor.
    pub fn problem_with_deviations(&self, factor: f64) -> Problem<'a> {
        let columns = self.deviation_columns();
        let visible = columns.visible.iter().filter(|_| factor > 0.0);
        let scaled = visible.map(|deviation| deviation.scaled(factor));
        self.base.clone().with_deviations(scaled.collect())
    }

    /// The fit with the deviations of the parts, if the one without leaves more than noise, which they explain, and all are within
    /// their tolerances. Sets are compared there: around exact parts, causes are fitted in full, but small deviations only linearly.
    pub fn within_tolerances(&self) -> Result<Option<Self>, EstimationError> {
        if !self.problem.deviations.is_empty() || self.chi2_per_freedom() < MORE_THAN_NOISE {
            return Ok(None);
        }
        let fit = Self::new(
            &self.problem_with_deviations(FACTORS[AS_STATED]),
            &self.causes,
        )?;
        let remaining = (fit.chi2_per_freedom() - 1.0) / (self.chi2_per_freedom() - 1.0);
        if remaining > MOST_LEFT || !fit.has_deviations_within(LARGEST_DEVIATION) {
            return Ok(None);
        }
        let base = fit.base.clone().at_poses_of(&fit.solution);
        Self::new(&base, &fit.causes).map(Some)
    }

    /// Whether all estimated deviations of the parts are within `most` standard deviations of their priors.
    fn has_deviations_within(&self, most: f64) -> bool {
        let held = self.problem.held_deviations.len();
        let estimated = &self.solution.globals.deviations[held..];
        let pairs = self.problem.deviations.iter().zip(estimated);
        let mut values = pairs.flat_map(|(part, estimated)| {
            let values = estimated.values.iter().zip(&part.bound.values);
            values.zip(&part.prior_sd)
        });
        values.all(|((value, neutral), sd)| (value - neutral).abs() <= most * sd)
    }

    /// Chi-square per degree of freedom.
    pub fn chi2_per_freedom(&self) -> f64 {
        self.solution.chi2 / self.solution.degrees_of_freedom
    }

    /// The columns of the deviations at this fit.
    pub fn deviation_columns(&self) -> Rc<DeviationColumns> {
        let new = || Rc::new(self.own_deviation_columns());
        Rc::clone(self.deviation_columns.get_or_init(new))
    }

    /// The columns of the deviations evaluated at this fit, even if it uses those of another fit.
    pub fn own_deviation_columns(&self) -> DeviationColumns {
        DeviationColumns::new(&self.problem, &self.solution, self.model_effects())
    }

    /// The same fit with the columns of the deviations of another one, which are small and hardly depend on the fit.
    pub fn with_deviation_columns(self, columns: &Rc<DeviationColumns>) -> Self {
        Self {
            deviation_columns: OnceCell::from(Rc::clone(columns)),
            ..self
        }
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

    /// Indices of the effects of one cause among the free ones.
    pub fn effects_of(&self, cause: usize) -> Range<usize> {
        let before = self.causes[..cause].iter().map(|c| c.instances.len());
        let first = self.model_effects() + before.sum::<usize>();
        first..first + self.causes[cause].instances.len()
    }

    /// Indices of the parameters of one cause in the solution.
    pub fn parameters_of(&self, cause: usize) -> Vec<usize> {
        let effects = self.effects_of(cause);
        let is_own = |id: &ParameterId| match id {
            ParameterId::Effect { effect, .. } => effects.contains(effect),
            _ => false,
        };
        let parameters = self.solution.parameters.iter();
        let numbered = parameters.enumerate().filter(|(_, p)| is_own(&p.id));
        numbered.map(|(k, _)| k).collect()
    }
}
