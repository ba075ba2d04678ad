//! The sequence of steps of a diagnosis.

use std::sync::Arc;

use super::calibration::{LISTED_DRAWING, POWER, log_naming_odds};
use super::candidates::size_parameter;
use super::cause_posteriors::{CausePosterior, cause_posteriors, stated_causes};
use super::cause_sets::set_probabilities;
use super::confidence::{
    ConfirmedCauses, add_alternative, allow_for_errors, assess_fit, confirm_causes, log_rarity_of,
    reject_replaceable_causes, state_probabilities,
};
use super::drawing::{DrawingEvidence, drawing_evidence, with_wider_places, wrong_drawing};
use super::exchange::{Channels, find_exchange};
use super::exploration::Visibility;
use super::finding::FindingBuilder;
use super::fit::Fit;
use super::fitted_problem::{
    chi2_with, independent_dataset, problem_at_fitted_poses, usual_variance, with_variance,
};
use super::gain::Prediction;
use super::inference::{Inference, infer, inference_at_fit};
use super::linear_fit::LinearFit;
use super::noise::noise_statements;
use super::priors::{AS_STATED, EXPECTED_CAUSES, FACTORS, MOST_WIDER, RELATIVE_SD};
use super::progress::Reporter;
use super::report::{
    Cause, Diagnosis, Discrepancy, Finding, Invisible, PossibleCause, Subject, ToleranceFactor,
    UnseenFault,
};
use super::residual_space::ResidualSpace;
use super::slack::{Rival, find_slack, without_cables};
use super::unmodelled_errors::{UnmodelledErrors, WeighedError};
use super::unseen::unseen_faults;
use super::{DiagnosisOptions, Observer, Stage};
use crate::effect::{CATALOGUE, CablePorts, Dual, Scope};
use crate::estimation::{EstimationError, Problem};
use crate::measurement::Dataset;
use crate::robot::Robot;
use crate::statistics::{logit, normal_quantile};

/// Diagnoses a dataset with the joint problem of its robot. The effects of its model are estimated in every set of
/// causes, as the geometry is. Rows of one standstill are averaged, recordings in motion are thinned to independent
/// samples, and so are very many poses.
///
/// # Errors
/// If the measurements cannot be used with this robot at all.
pub fn diagnose(
    dataset: &Dataset,
    options: &DiagnosisOptions,
    observer: &mut Observer<'_>,
) -> Result<Diagnosis, EstimationError> {
    let mut report = Reporter::new(observer);
    report.stage(Stage::BaseFit, 0);
    let (independent, rows) = independent_dataset(dataset)?;
    let data = (&independent, rows);
    let mut found = diagnose_independent(data, options, &mut report)?;
    if !found.base.adequate && !found.cancelled {
        allow_for_slack(data, &mut found, options, &mut report)?;
    }
    let is_slack = found.slack.as_ref().is_some_and(|slack| slack.is_left_out);
    let of_wider = match !found.base.adequate && !found.cancelled && !is_slack {
        true => allow_for_wrong_drawing(data, &mut found, options, &mut report)?,
        false => None,
    };
    if (found.extended.adequate || of_wider.is_some()) && found.extended_solution.converged() {
        let widening = of_wider.map_or(1.0, |_| MOST_WIDER);
        let (robot, solution) = (&dataset.robot, &found.extended_solution);
        found.drawing = drawing_evidence(robot, solution, widening).and_then(|evidence| {
            let log_odds = of_wider.unwrap_or(evidence.log_odds);
            let is_listed = log_odds > logit(LISTED_DRAWING);
            is_listed.then(|| wrong_drawing(robot, solution, evidence.pattern, log_odds))?
        });
    }
    found.tolerances.are_stated = dataset.robot.tolerances.is_some();
    Ok(found)
}

/// Diagnoses with places of the pulleys that are known less well, if that is likelier than what was found; its log odds if it is.
fn allow_for_wrong_drawing(
    (dataset, rows): (&Dataset, usize),
    found: &mut Diagnosis,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Option<f64>, EstimationError> {
    let wider = Dataset {
        robot: with_wider_places(&dataset.robot),
        measurements: dataset.measurements.clone(),
    };
    // Both are compared at the noise that is left with such places, unless causes leave none but that stated.
    let variance = match found.extended.adequate {
        true => 1.0,
        false => usual_variance(&wider, FACTORS[AS_STATED])?,
    };
    let [stated, wide] = [dataset, &wider].map(|data| with_variance(data, variance));
    let at_wide = Fit::new(&problem_at_fitted_poses(&wide)?, &[])?.solution;
    let alone = drawing_evidence(&dataset.robot, &at_wide, MOST_WIDER);
    if alone.is_none_or(|evidence| evidence.log_odds < 0.0) {
        return Ok(None);
    }
    let is_noisier = variance > 1.0;
    let mut diagnosed = |data| diagnose_independent((data, rows), options, report);
    let other = diagnosed(&wide)?;
    if other.cancelled {
        *found = other;
        return Ok(None);
    }
    let solution = &other.extended_solution;
    let evidence = drawing_evidence(&dataset.robot, solution, MOST_WIDER);
    // The stated places may also be right beside the causes that are found with wider ones.
    let may_be_wrong = |one: &DrawingEvidence| one.log_odds > -log_naming_odds();
    let Some(evidence) = evidence.filter(|one| solution.converged() && may_be_wrong(one)) else {
        return Ok(None);
    };
    // Errors that wider places leave are none of the drawing, which is then judged by the readings of the other cables.
    let also = cables_of_errors(&other);
    let mut doubtful = cables_of_errors(found);
    doubtful.retain(|cable| also.contains(cable));
    if !doubtful.is_empty() {
        let rest = without_cables(dataset, &doubtful);
        let Ok(mut of_rest) = diagnosed(&rest) else {
            // The other readings do not determine the poses.
            return Ok(None);
        };
        let is_wrong = !of_rest.base.adequate
            && !of_rest.cancelled
            && allow_for_wrong_drawing((&rest, rows), &mut of_rest, options, report)?.is_some();
        found.cancelled |= of_rest.cancelled;
        if !is_wrong || found.cancelled {
            return Ok(None);
        }
    }
    let as_stated = match is_noisier {
        true => Some(diagnose_independent((&stated, rows), options, report)?),
        false => None,
    };
    let robot = &dataset.robot;
    let known = evidence.of_stated + log_evidence(as_stated.as_ref().unwrap_or(found), robot, 1.0);
    let wrong = evidence.of_wider + log_evidence(&other, robot, 1.0);
    let log_odds = evidence.log_odds.min(wrong - known);
    let is_open = log_odds.abs() < log_naming_odds();
    let subject = Subject::WrongDrawing(evidence.pattern);
    let is_listed = is_open && list_beside_causes(found, &subject, &other, log_odds);
    if is_listed || log_odds < 0.0 {
        return Ok(None);
    }
    *found = match is_noisier {
        true => diagnose_independent((&wider, rows), options, report)?,
        false => other,
    };
    Ok((!found.cancelled).then_some(log_odds))
}

/// Adds a subject to what may be there instead of the causes that are found without it, but not with it; whether there are any.
fn list_beside_causes(
    found: &mut Diagnosis,
    subject: &Subject,
    with: &Diagnosis,
    log_odds: f64,
) -> bool {
    let probability = 1.0 / (1.0 + (-log_odds).exp());
    let is_known = |finding: &Finding| {
        let key = |one: &Finding| Some((one.cause()?.effect().id(), one.subject.cables()));
        key(finding).is_none() || with.findings.iter().any(|one| key(one) == key(finding))
    };
    let mut unknown: Vec<&mut Finding> = found.findings.iter_mut().collect();
    unknown.retain(|finding| !is_known(finding));
    for finding in &mut unknown {
        finding.probability *= 1.0 - probability;
        (finding.alternatives.iter_mut()).for_each(|other| other.probability *= 1.0 - probability);
        add_alternative(finding, subject.clone(), probability);
    }
    !unknown.is_empty()
}

/// Cables in whose readings a diagnosis leaves an error without a name.
fn cables_of_errors(found: &Diagnosis) -> Vec<usize> {
    let findings = found.findings.iter();
    let errors = findings.filter(|finding| finding.cause().is_none());
    errors.flat_map(|error| error.subject.cables()).collect()
}

/// Diagnoses without the readings of a slack cable, if that is likelier than what was found with them, else says that it may be.
fn allow_for_slack(
    (dataset, rows): (&Dataset, usize),
    found: &mut Diagnosis,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<(), EstimationError> {
    let variance = usual_variance(dataset, 0.0)?;
    let known = log_evidence(found, &dataset.robot, variance);
    let rival = Rival {
        variance,
        least: known - log_naming_odds(),
        chi2: if found.extended.adequate {
            found.extended.global.chi2
        } else {
            0.0
        },
    };
    let mut go_on = || report.stage(Stage::Refits, found.findings.len());
    let Some(without) = find_slack(dataset, &rival, &mut go_on)? else {
        return Ok(());
    };
    let mut slack = without.slack;
    slack.log_odds = without.log_evidence - known;
    let mut other = diagnose_independent((&without.dataset, rows), options, report)?;
    let is_open = slack.log_odds.abs() < log_naming_odds();
    let subject = Subject::Slack(slack.cable);
    let is_listed = is_open && list_beside_causes(found, &subject, &other, slack.log_odds);
    if is_listed || slack.log_odds < 0.0 {
        found.slack = Some(slack);
    } else if other.extended.adequate || !found.extended.adequate {
        // Causes that are found without these readings may explain them, too.
        let causes: Vec<Cause> = (other.findings.iter())
            .filter_map(|finding| finding.cause().cloned())
            .collect();
        let chi2 = chi2_with(dataset, &causes, other.tolerances.factor)?;
        let beside = without.log_prior - 0.5 * other.extended.global.chi2 / variance;
        slack.is_left_out = beside > -0.5 * chi2 / variance;
        other.slack = Some(slack).filter(|slack| slack.is_left_out);
        *found = other;
    }
    Ok(())
}

/// Approximate log evidence of the extended model of a diagnosis: half of chi-square, and for each finding its prior probability and
/// what the estimation of its parameters costs (Laplace), the more the less usual its size. `variance` is that of the readings in that
/// stated.
fn log_evidence(found: &Diagnosis, robot: &Robot, variance: f64) -> f64 {
    let of_finding = |finding: &Finding| {
        let Some(cause) = finding.cause() else {
            return 0.0;
        };
        let cables = if cause.effect().scope() == Scope::Robot {
            1
        } else {
            found.extended_solution.globals.entry_points.len()
        };
        let places = if cause.effect().pose_parameter().is_some() {
            found.extended_solution.poses.len()
        } else {
            1
        };
        let share = EXPECTED_CAUSES / (CATALOGUE.len() * cables * places) as f64;
        let parameters = cause
            .effect()
            .parameters()
            .iter()
            .cycle()
            .zip(&finding.parameters);
        let cost = parameters.filter_map(|(parameter, found)| {
            let prior_sd = RELATIVE_SD * parameter.largest_in(robot);
            Some((prior_sd / found.sd?).ln().max(0.0))
        });
        share.ln() - cost.sum::<f64>() - log_rarity_of(finding, robot)
    };
    let findings = found.findings.iter().map(of_finding);
    findings.sum::<f64>() - 0.5 * found.extended.global.chi2 / variance
}

/// Diagnoses independent rows; `rows` is the largest number that was averaged.
fn diagnose_independent(
    (dataset, rows): (&Dataset, usize),
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Diagnosis, EstimationError> {
    report.stage(Stage::BaseFit, 0);
    let mut problem = problem_at_fitted_poses(dataset)?;
    let mut first = Fit::new(&problem, &[])?;
    let channels = find_exchange(&first, report)?;
    if let Channels::PulleysExchanged(solution) = &channels {
        problem = problem.at_poses_of(solution);
        first = Fit::new(&problem, &[])?;
    }
    match &channels {
        Channels::Exchanged(exchange) => {
            let mut after = problem_at_fitted_poses(&exchange.dataset)?;
            after.held_effects.extend(exchange.bounds.iter().cloned());
            let second = Fit::new(&after, &[])?;
            let exchanged = exchange.findings(&first, &second);
            examine(&after, (&first, rows), exchanged, options, report)
        }
        _ => examine(&problem, (&first, rows), Vec::new(), options, report),
    }
}

/// Examines a problem. `first` is the fit of the model as supplied, `rows` the largest number of averaged rows of a
/// standstill. An interrupted examination names nothing and lists what the search has found so far.
fn examine(
    problem: &Problem<'_>,
    (first, rows): (&Fit<'_>, usize),
    exchanged: Vec<Finding>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Diagnosis, EstimationError> {
    let (inference, visibility) = infer(problem, options, report)?;
    let (posteriors, mut possible) = cause_posteriors(&inference.ranking);
    let sets = set_probabilities(&inference.ranking);
    let factor = FACTORS[inference.hyper.factor];
    let first = match factor > 0.0 {
        true => &Fit::new(&first.problem_with_deviations(factor), &[])?,
        false => first,
    };
    let mut all_possible = possible.clone();
    for (cause, posterior) in inference.fit.causes.iter().zip(&posteriors) {
        all_possible.extend(posterior.as_possible(cause));
    }
    let found = match report.stage(Stage::Refits, exchanged.len()) {
        true => confirmed_findings(
            (inference, posteriors, &mut possible),
            (exchanged.clone(), visibility.len()),
            report,
        )?,
        false => None,
    };
    let (base, discrepancies, base_space) = assess_fit(first, options.alpha);
    let (invisible, readable) = invisible_effects(problem, &visibility, options);
    // The noise of means is smaller than that of single rows by a factor that depends on what the rows share, so less
    // noise than described is not reported for them.
    let noise_of = |space: &ResidualSpace, dependences: &[Discrepancy]| {
        let mut noise = noise_statements(space, dependences, options.alpha);
        noise.retain(|statement| rows == 1 || statement.ratio > 1.0);
        noise
    };
    let mut diagnosis = Diagnosis {
        noise: Vec::new(),
        extended: base.clone(),
        base,
        drawing: None,
        slack: None,
        remaining: discrepancies.clone(),
        discrepancies,
        invisible,
        readable,
        findings: exchanged,
        possible: all_possible,
        sets,
        unseen: Vec::new(),
        tolerances: ToleranceFactor {
            factor,
            are_stated: false,
        },
        held: first.problem.held_effects.len(),
        base_solution: first.solution.clone(),
        extended_solution: first.solution.clone(),
        cancelled: found.is_none(),
    };
    if let Some((mut findings, confirmed, unmodelled)) = found {
        let inference = &confirmed.inference;
        let fit = &inference.fit;
        let (extended, remaining, space) = assess_fit(fit, options.alpha);
        let mut remaining_errors = unmodelled.remaining;
        if remaining_errors.is_empty() {
            remaining_errors.extend(remaining.first().map(WeighedError::from_discrepancy));
        }
        let of_errors = allow_for_errors(&mut findings, &unmodelled.rivals);
        state_probabilities(&mut findings, inference, &confirmed.posteriors, &of_errors);
        findings.extend(remaining_errors.iter().map(|s| s.finding(fit)));
        // Nothing is named by a fit that did not converge or is worse than the one without causes.
        let is_better =
            fit.solution.converged() && extended.global.chi2 <= diagnosis.base.global.chi2;
        findings.retain(|finding| is_better || finding.cause().is_none());
        diagnosis.noise = noise_of(&space, &remaining);
        diagnosis.unseen = unseen_beside(inference);
        diagnosis.tolerances.factor = inference.tolerance_factor();
        diagnosis.possible = possible;
        diagnosis.findings = findings;
        diagnosis.remaining = remaining;
        if is_better {
            diagnosis.extended = extended;
            diagnosis.extended_solution = fit.solution.clone();
        }
    } else {
        diagnosis.noise = noise_of(&base_space, &diagnosis.discrepancies);
    }
    diagnosis.possible = stated_causes(diagnosis.possible);
    diagnosis.base.adequate &= diagnosis.findings.is_empty();
    Ok(diagnosis)
}

/// The findings of the causes that are confirmed, after those of exchanged channels, with their fit and the errors that no
/// cause explains; `None` if interrupted. Other causes go to the possible ones; `questions` is the number of causes tested.
fn confirmed_findings<'a>(
    (inference, posteriors, possible): (
        Inference<'a>,
        Vec<CausePosterior>,
        &mut Vec<PossibleCause>,
    ),
    (mut findings, questions): (Vec<Finding>, usize),
    report: &mut Reporter<'_, '_>,
) -> Result<Option<(Vec<Finding>, ConfirmedCauses<'a>, UnmodelledErrors)>, EstimationError> {
    let factor = FACTORS[inference.hyper.factor];
    let problem = inference.fit.base().clone();
    let (problem, inference) = match factor > 0.0 || !problem.deviations.is_empty() {
        true => infer_with_deviations(factor, inference)?,
        false => (problem, inference),
    };
    let confirmed = confirm_causes(&problem, inference, posteriors, possible)?;
    let rejected = reject_replaceable_causes(&problem, confirmed, possible, report)?;
    let Some((confirmed, unmodelled)) = rejected else {
        return Ok(None);
    };
    let fit = &confirmed.inference.fit;
    let sds = confirmed.inference.sds();
    let mut before = Prediction::new(&Fit::new(&problem, &[])?);
    for (index, posterior) in confirmed.posteriors.iter().enumerate() {
        if !report.stage(Stage::HeldOut, findings.len()) {
            return Ok(None);
        }
        let after = Prediction::new(&Fit::new(&problem, &fit.causes[..=index])?);
        let gain = after.gain_over(&before);
        before = after;
        if !report.stage(Stage::Separation, findings.len()) {
            return Ok(None);
        }
        let found = FindingBuilder {
            fit,
            index,
            posterior,
            gain,
            questions,
            sds: &sds[index],
        };
        findings.push(found.build()?);
    }
    Ok(Some((findings, confirmed, unmodelled)))
}

/// Faults that the readings do not exclude beside the causes of an inference.
fn unseen_beside(inference: &Inference<'_>) -> Vec<UnseenFault> {
    let at = LinearFit::new(&inference.fit, true);
    let gram = at.gram_beside_present(&inference.hyper);
    let present: Vec<usize> = at.present.iter().map(|member| member.0).collect();
    unseen_faults(&gram, &present)
}

/// The inference with the deviations of `problem` in the nonlinear fit, too, so that the sizes of the causes and all that is
/// reported allow for them. While sets are compared, their changes count linearly.
fn infer_with_deviations<'a>(
    factor: f64,
    inference: Inference<'a>,
) -> Result<(Problem<'a>, Inference<'a>), EstimationError> {
    let mut problem = inference.fit.problem_with_deviations(factor);
    let fit = Fit::new(&problem, &inference.fit.causes)?;
    let columns = inference.fit.deviation_columns();
    let fit = fit.with_deviation_columns(&columns);
    problem.known = Some(Arc::new(fit.solution.clone()));
    let start = Some(&*inference.hyper.variance);
    let inference = inference_at_fit(fit, inference.ranking, start);
    Ok((problem, inference))
}

/// Effects that would not be found even at their largest typical size, and the number of effects considered. Effects of
/// instruments that the robot does not have are left out.
fn invisible_effects(
    problem: &Problem<'_>,
    visibility: &[Visibility],
    options: &DiagnosisOptions,
) -> (Vec<Invisible>, usize) {
    let tail = options.alpha / (2.0 * visibility.len().max(1) as f64);
    let needed = normal_quantile(1.0 - tail) + normal_quantile(POWER);
    let has_forces = problem.dataset.robot.has_force_sensors()
        && !problem.dataset.measurements.force_n.is_empty();
    let (mut found, mut readable) = (Vec::new(), 0);
    for effect in visibility {
        let is_read = effect.is_read && (has_forces || !acts_on_tension(effect, problem));
        let Some(parameter) = size_parameter(effect.cause.effect()).filter(|_| is_read) else {
            continue;
        };
        readable += 1;
        let smallest = effect.sd.map(|sd| needed * sd);
        if smallest.is_none_or(|size| size > parameter.typical[1]) {
            found.push(Invisible {
                cause: effect.cause.clone(),
                parameter: (parameter.name, parameter.unit),
                smallest_visible: smallest,
            });
        }
    }
    (found, readable)
}

/// Whether an effect acts only through tensions that force sensors read.
fn acts_on_tension(effect: &Visibility, problem: &Problem<'_>) -> bool {
    let bound = &effect.cause.instances[0];
    let (Some(cable), Some(contexts)) = (bound.cables.first(), &problem.contexts) else {
        return false;
    };
    let robot = &problem.dataset.robot;
    let values: Vec<Dual> = bound.values.iter().map(|v| Dual::variable(*v)).collect();
    (0..problem.dataset.measurements.len()).any(|row| {
        let mut ports = CablePorts::nominal(&robot.cables[*cable], 0.0, 1.0);
        bound.change_cable(&values, contexts.at_row(row), *cable, &mut ports);
        ports.tension.slope != 0.0
    })
}
