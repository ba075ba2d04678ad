//! Decides which inferred causes are confirmed and with which probability they are stated.

use super::Stage;
use super::adequacy::adequacy;
use super::budget::{MAX_ALTERNATIVES, MIN_POSSIBLE_PROBABILITY};
use super::calibration::share_of_atypical_size;
use super::candidates::{log_rarity, size_parameter};
use super::cause_posteriors::{CausePosterior, stated_share};
use super::cause_sets::has_possible_values;
use super::discrepancy::{dependence_tests, discrepancies};
use super::fit::Fit;
use super::inference::{Inference, inference_at_fit};
use super::progress::Reporter;
use super::report::{
    Adequacy, Alternative, Cause, Discrepancy, Finding, FoundParameter, PossibleCause, Subject,
    UnmodelledError, Verdict,
};
use super::residual_space::ResidualSpace;
use super::unmodelled_errors::{UnmodelledErrors, WeighedError};
use super::variables::Variables;
use crate::estimation::{EstimationError, Problem};
use crate::robot::Robot;

/// Confirmed causes with their posteriors.
pub(super) struct ConfirmedCauses<'a> {
    pub inference: Inference<'a>,
    pub posteriors: Vec<CausePosterior>,
}

/// Rejects causes than which an unmodelled error in their place is likelier, refitting until none is left; `None` if
/// interrupted. What is rejected stays possible.
pub(super) fn reject_replaceable_causes<'a>(
    problem: &Problem<'a>,
    confirmed: ConfirmedCauses<'a>,
    possible: &mut Vec<PossibleCause>,
    report: &mut Reporter<'_, '_>,
) -> Result<Option<(ConfirmedCauses<'a>, UnmodelledErrors)>, EstimationError> {
    let ConfirmedCauses {
        mut inference,
        mut posteriors,
    } = confirmed;
    let mut replacements: Vec<WeighedError> = Vec::new();
    loop {
        let mut go_on = || report.stage(Stage::Discrepancy, posteriors.len());
        let Some(mut unmodelled) = UnmodelledErrors::new(&inference, &mut go_on) else {
            return Ok(None);
        };
        let mut causes = Vec::new();
        let mut accepted = Vec::new();
        let judged = inference.fit.causes.iter().zip(posteriors);
        for ((cause, posterior), rival) in judged.zip(&unmodelled.rivals) {
            let Some(rival) = rival.as_ref().filter(|rival| rival.log_odds > 0.0) else {
                causes.push(cause.clone());
                accepted.push(posterior);
                continue;
            };
            let reduced = |other: PossibleCause| PossibleCause {
                probability: other.probability * (1.0 - rival.probability()),
                ..other
            };
            possible.extend(posterior.as_possible(cause).map(reduced));
            replacements.push(rival.clone());
        }
        posteriors = accepted;
        if causes.len() == inference.fit.causes.len() {
            for rival in replacements {
                if unmodelled
                    .remaining
                    .iter()
                    .all(|other| other.error.readings != rival.error.readings)
                {
                    unmodelled.remaining.push(rival);
                }
            }
            let confirmed = ConfirmedCauses {
                inference,
                posteriors,
            };
            return Ok(Some((confirmed, unmodelled)));
        }
        let fit = fit_of_possible(problem, causes, &mut posteriors)?;
        let fit = fit.with_deviation_columns(&inference.fit.deviation_columns());
        inference = inference_at_fit(fit, Vec::new(), Some(&inference.hyper.variance));
    }
}

/// Fits some of the causes of another fit without the rest, and without those whose values are then physically impossible.
fn fit_of_possible<'a>(
    problem: &Problem<'a>,
    mut causes: Vec<Cause>,
    posteriors: &mut Vec<CausePosterior>,
) -> Result<Fit<'a>, EstimationError> {
    loop {
        let fit = Fit::new(problem, &causes)?;
        let robot = &problem.dataset.robot;
        let impossible = fit
            .causes
            .iter()
            .position(|c| !has_possible_values(c, robot));
        let Some(impossible) = impossible else {
            return Ok(fit);
        };
        causes.remove(impossible);
        posteriors.remove(impossible);
    }
}

/// Confirms the causes that are nearly certain, and refits the model with those alone. The others become possible causes.
pub(super) fn confirm_causes<'a>(
    problem: &Problem<'a>,
    inference: Inference<'a>,
    posteriors: Vec<CausePosterior>,
    possible: &mut Vec<PossibleCause>,
) -> Result<ConfirmedCauses<'a>, EstimationError> {
    let mut confirmed: Vec<(f64, Cause, CausePosterior)> = Vec::new();
    for (index, (cause, posterior)) in inference.fit.causes.iter().zip(posteriors).enumerate() {
        if posterior.is_near_certain() {
            let mut others = inference.fit.causes.clone();
            others.remove(index);
            let without = Fit::new(problem, &others)?;
            confirmed.push((without.solution.chi2, cause.clone(), posterior));
            continue;
        }
        possible.extend(posterior.as_possible(cause));
    }
    let is_complete = confirmed.len() == inference.fit.causes.len();
    let is_ordered = confirmed.windows(2).all(|pair| pair[0].0 >= pair[1].0);
    // The cause that explains most comes first.
    confirmed.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (causes, mut posteriors): (Vec<_>, Vec<_>) = confirmed
        .into_iter()
        .map(|(_, cause, posterior)| (cause, posterior))
        .unzip();
    let inference = if is_complete && is_ordered {
        inference
    } else {
        let fit = fit_of_possible(problem, causes, &mut posteriors)?;
        let fit = fit.with_deviation_columns(&inference.fit.deviation_columns());
        inference_at_fit(fit, Vec::new(), Some(&inference.hyper.variance))
    };
    Ok(ConfirmedCauses {
        inference,
        posteriors,
    })
}

/// Shares the probability of each cause with the error that may replace it. Returns the probability that each cause lost.
/// `rivals` belong to the last findings: exchanged channels come first and have none.
pub(super) fn allow_for_errors(
    findings: &mut [Finding],
    rivals: &[Option<WeighedError>],
) -> Vec<f64> {
    let first = findings.len() - rivals.len();
    let lost = |(index, finding): (usize, &mut Finding)| {
        let rival = index.checked_sub(first).and_then(|k| rivals[k].as_ref());
        let lost = rival.map_or(0.0, |rival| finding.probability * rival.probability());
        finding.probability -= lost;
        add_error(finding, rival.map(|rival| rival.error.clone()), lost);
        lost
    };
    findings.iter_mut().enumerate().map(lost).collect()
}

/// Adds an error to the alternatives of a finding, unless its probability is too small to be said.
fn add_error(finding: &mut Finding, error: Option<UnmodelledError>, probability: f64) {
    if let Some(error) = error.filter(|_| probability >= MIN_POSSIBLE_PROBABILITY) {
        add_alternative(finding, Subject::UnmodelledError(error), probability);
    }
}

/// Adds an alternative to a finding, in place of the least probable one if it has many.
pub(super) fn add_alternative(finding: &mut Finding, subject: Subject, probability: f64) {
    let alternative = Alternative {
        subject,
        probability,
    };
    finding.alternatives.truncate(MAX_ALTERNATIVES - 1);
    finding.alternatives.push(alternative);
}

/// Turns the computed probabilities of the findings into stated ones; a named cause has no alternatives. `posteriors` belong to
/// the last findings, `of_errors` has the probability that each finding lost to errors.
pub(super) fn state_probabilities(
    findings: &mut [Finding],
    inference: &Inference<'_>,
    posteriors: &[CausePosterior],
    of_errors: &[f64],
) {
    let first = findings.len() - posteriors.len();
    for (index, (finding, lost)) in findings.iter_mut().zip(of_errors).enumerate() {
        let k = index.checked_sub(first);
        let others = finding.alternatives.iter().map(|other| other.probability);
        // One of the causes is present, or an error that none of them explains.
        let computed = match k {
            Some(k) => posteriors[k].with_replacements - lost,
            None => finding.probability + others.sum::<f64>(),
        };
        let of_causes = stated_share(computed);
        let of_errors = (1.0 - computed * of_causes) / (1.0 - computed).max(f64::MIN_POSITIVE);
        finding.probability *= of_causes;
        for other in &mut finding.alternatives {
            other.probability *= match other.subject {
                Subject::Cause(_) => of_causes,
                Subject::UnmodelledError(_) | Subject::WrongDrawing(_) | Subject::Slack(_) => {
                    of_errors
                }
            };
        }
        let log_rarity = log_rarity_of(finding, &inference.fit.problem.dataset.robot);
        let atypical = finding.probability * (1.0 - share_of_atypical_size(log_rarity));
        finding.probability -= atypical;
        let scatter = k.and_then(|k| inference.scatter_like(k));
        add_error(finding, scatter, atypical);
        if finding.verdict() == Verdict::Named {
            finding.alternatives.clear();
        }
    }
}

/// Log prior rarity of the size of a cause, relative to the largest typical size, at the lower end of its confidence
/// interval.
pub(super) fn log_rarity_of(finding: &Finding, robot: &Robot) -> f64 {
    let Some(effect) = finding.cause().map(Cause::effect) else {
        return 0.0;
    };
    let Some(size) = size_parameter(effect) else {
        return 0.0;
    };
    // The typical size of a vector bounds each of its coordinates, so their squares are summed.
    let of_instance = |parameters: &[FoundParameter]| {
        let alike = effect.parameters().iter().zip(parameters);
        let alike = alike.filter(|(p, _)| p.unit == size.unit && !p.discrete);
        let squares = alike.map(|(p, parameter)| {
            let certain = (parameter.value - p.neutral).abs() - 2.0 * parameter.sd.unwrap_or(0.0);
            (certain.max(0.0) / p.largest_in(robot)).powi(2)
        });
        squares.sum::<f64>().sqrt()
    };
    let instances = finding.parameters.chunks(effect.parameters().len());
    log_rarity(size, instances.map(of_instance).fold(0.0, f64::max))
}

/// Tests whether a fit explains the data and on which variables its residuals depend.
pub(super) fn assess_fit(fit: &Fit<'_>, alpha: f64) -> (Adequacy, Vec<Discrepancy>, ResidualSpace) {
    // Half of the level is for the test of the whole fit, half for the dependences of its residuals.
    let level = alpha / 2.0;
    let linear = fit.linearisation();
    let space = ResidualSpace::new(&linear);
    let variables = Variables::new(&fit.problem, &fit.solution, &linear);
    let tests = dependence_tests(&space, &variables);
    let dependences = discrepancies(&space, &tests, level);
    (adequacy(&space, &fit.solution, level), dependences, space)
}
