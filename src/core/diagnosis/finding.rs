//! Findings: confirmed causes, fitted and tested on held-out poses.

use super::cause_posteriors::CausePosterior;
use super::fit::Fit;
use super::gain::Prediction;
use super::report::{
    Alternative, Cause, Evidence, Finding, FoundParameter, Gain, PossibleCause, Rival, Subject,
};
use super::separation::separation;
use crate::estimation::{EstimationError, ParameterId};
use crate::statistics::chi_square_survival;

/// Data for the finding of one cause of a fit.
pub(super) struct FindingBuilder<'f, 'a> {
    /// The fit of all confirmed causes.
    pub fit: &'f Fit<'a>,
    /// Index of the cause in the fit.
    pub index: usize,
    pub posterior: &'f CausePosterior,
    /// Gain on held-out poses over the causes before it.
    pub gain: Gain,
    /// Number of causes that were tested.
    pub questions: usize,
    /// Standard deviations of its estimated parameters.
    pub sds: &'f [Option<f64>],
}

impl FindingBuilder<'_, '_> {
    pub fn build(&self) -> Result<Finding, EstimationError> {
        let fit = self.fit;
        let cause = &fit.causes[self.index];
        let mut others = fit.causes.clone();
        others.remove(self.index);
        let without = Fit::new(fit.base(), &others)?;
        let rivals = self.rivals(&others)?;
        let is_named = self.posterior.is_named();
        let separation = rivals.first().filter(|_| !is_named).and_then(|rival| {
            let fit = self.fit_with_last(&others, cause).ok()?;
            separation(&fit, rival)
        });
        let ranking = ranking(&without, fit, self.index, &rivals);
        let [sentence, advice] = cause.in_words(&fit.problem.dataset.robot);
        let delta_chi2 = without.solution.chi2 - fit.solution.chi2;
        let parameters = fit.parameters_of(self.index).len();
        let p_value = chi_square_survival(delta_chi2, parameters as f64).unwrap_or(1.0);
        Ok(Finding {
            probability: self.posterior.probability,
            sentence,
            advice,
            alternatives: self.alternatives(&rivals),
            parameters: self.parameters(),
            evidence: Evidence {
                delta_chi2,
                parameters,
                p_value: (p_value * self.questions as f64).min(1.0),
                questions: self.questions,
                ranking,
            },
            gain: self.gain.clone(),
            separation,
            subject: Subject::Cause(cause.clone()),
        })
    }

    /// Fits the other causes together with `cause`, which comes last.
    fn fit_with_last(&self, others: &[Cause], cause: &Cause) -> Result<Fit<'_>, EstimationError> {
        let mut causes = others.to_vec();
        causes.push(cause.clone());
        Fit::new(self.fit.base(), &causes)
    }

    /// Fits each alternative in place of the cause.
    fn rivals(&self, others: &[Cause]) -> Result<Vec<Fit<'_>>, EstimationError> {
        let alternatives = self.posterior.alternatives.iter();
        alternatives
            .map(|alternative| self.fit_with_last(others, &at_start_values(&alternative.cause)))
            .collect()
    }

    fn alternatives(&self, rivals: &[Fit<'_>]) -> Vec<Alternative> {
        let pairs = self.posterior.alternatives.iter().zip(rivals);
        let fitted = |(alternative, fit): (&PossibleCause, &Fit<'_>)| Alternative {
            subject: Subject::Cause(fit.causes.last().unwrap_or(&alternative.cause).clone()),
            probability: alternative.probability,
        };
        pairs.map(fitted).collect()
    }

    /// The parameters of the cause in the final model.
    fn parameters(&self) -> Vec<FoundParameter> {
        let fit = self.fit;
        let effects = fit.effects_of(self.index);
        let cause = &fit.causes[self.index];
        let several = cause.instances.len() > 1;
        let mut parameters = Vec::new();
        let mut sds = self.sds.iter();
        for (effect, bound) in effects.zip(&cause.instances) {
            for (number, parameter) in bound.effect.parameters().iter().enumerate() {
                let id = ParameterId::Effect {
                    effect,
                    parameter: number,
                };
                let is_estimated = fit.solution.parameters.iter().any(|p| p.id == id);
                parameters.push(FoundParameter {
                    name: parameter.name,
                    cable: bound.cables.first().copied().filter(|_| several),
                    value: bound.values[number],
                    unit: parameter.unit,
                    sd: is_estimated.then(|| *sds.next()?).flatten(),
                });
            }
        }
        parameters
    }
}

/// A cause with its start values. Waves start at a tenth of their typical size, since the phase has no derivative at
/// amplitude zero.
fn at_start_values(cause: &Cause) -> Cause {
    let mut cause = cause.clone();
    for bound in &mut cause.instances {
        if let crate::effect::Search::Wave { phase, period } = bound.effect.search() {
            for k in (0..bound.values.len()).filter(|k| *k != phase && Some(*k) != period) {
                bound.values[k] = 0.1 * bound.effect.parameters()[k].typical[1];
            }
        }
    }
    cause
}

/// Compares the cause with its fitted alternatives; the cause comes first.
fn ranking(without: &Fit<'_>, fit: &Fit<'_>, index: usize, rivals: &[Fit<'_>]) -> Vec<Rival> {
    let last = |fit: &Fit<'_>| fit.causes.len() - 1;
    let fitted = rivals.iter().map(|fit| (fit, last(fit)));
    std::iter::once((fit, index))
        .chain(fitted)
        .map(|(fit, index)| Rival {
            cause: fit.causes[index].clone(),
            delta_chi2: without.solution.chi2 - fit.solution.chi2,
            parameters: fit.parameters_of(index).len(),
            holdout: Prediction::new(fit).rms(),
        })
        .collect()
}
