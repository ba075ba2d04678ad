//! The sequence of steps of a diagnosis.

use std::sync::Arc;

use super::budget::MOST_DIAGNOSED_ROWS;
use super::calibration::POWER;
use super::candidates::size_parameter;
use super::cause_posteriors::{cause_posteriors, stated_causes};
use super::cause_sets::set_probabilities;
use super::confidence::{
    ConfirmedCauses, allow_for_errors, assess_fit, confirm_causes, reject_replaceable_causes,
    state_probabilities,
};
use super::exchange::{Channels, find_exchange};
use super::exploration::Visibility;
use super::finding::FindingBuilder;
use super::fit::Fit;
use super::fitted_problem::{problem_at_fitted_poses, with_assumed_tolerances};
use super::gain::Prediction;
use super::inference::{Inference, infer, inference_at_fit};
use super::linear_fit::LinearFit;
use super::noise::noise_statements;
use super::priors::FACTORS;
use super::progress::Reporter;
use super::report::{Diagnosis, Finding, Invisible, ToleranceFactor, UnseenFault};
use super::unmodelled_errors::{UnmodelledErrors, WeighedError};
use super::unseen::unseen_faults;
use super::{DiagnosisOptions, Observer, Stage};
use crate::effect::{CablePorts, Dual, measurements_as_modelled};
use crate::estimation::{EstimationError, Problem};
use crate::measurement::Dataset;
use crate::statistics::normal_quantile;

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
    let measurements = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
    let (averaged, rows) = measurements.independent(&dataset.robot, MOST_DIAGNOSED_ROWS);
    let are_stated = dataset.robot.tolerances.is_some();
    let dataset = Dataset {
        robot: with_assumed_tolerances(&dataset.robot),
        measurements: averaged.into_owned(),
    };
    let mut problem = problem_at_fitted_poses(&dataset)?;
    let mut first = Fit::new(&problem, &[])?;
    let channels = find_exchange(&first, &mut report)?;
    if let Channels::PulleysExchanged(solution) = &channels {
        problem = problem.at_poses_of(solution);
        first = Fit::new(&problem, &[])?;
    }
    let mut found = match &channels {
        Channels::Exchanged(exchange) => {
            let mut after = problem_at_fitted_poses(&exchange.dataset)?;
            after.held_effects.push(exchange.bound.clone());
            let second = Fit::new(&after, &[])?;
            let exchanged = vec![exchange.finding(&first, &second)];
            examine(&after, (&first, rows), exchanged, options, &mut report)?
        }
        _ => examine(&problem, (&first, rows), Vec::new(), options, &mut report)?,
    };
    found.tolerances.are_stated = are_stated;
    Ok(found)
}

/// Examines a problem. `first` is the fit of the model as supplied, `rows` the largest number of averaged rows of a
/// standstill.
fn examine(
    problem: &Problem<'_>,
    (first, rows): (&Fit<'_>, usize),
    mut findings: Vec<Finding>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Diagnosis, EstimationError> {
    let (problem, inference, visibility) = infer(problem.clone(), options, report)?;
    let (posteriors, possible) = cause_posteriors(&inference.ranking);
    let sets = set_probabilities(&inference.ranking);
    let factor = FACTORS[inference.hyper.factor];
    let first = match factor > 0.0 {
        true => &Fit::new(&with_deviations(first, factor), &[])?,
        false => first,
    };
    let (problem, inference) = match factor > 0.0 {
        true => infer_with_deviations(factor, inference)?,
        false => (problem, inference),
    };
    let problem = &problem;
    let confirmed = confirm_causes(problem, inference, posteriors, possible)?;
    let (confirmed, unmodelled) = match report.cancelled && confirmed.posteriors.is_empty() {
        // There is nothing to reject, and errors without a cause are not told then.
        true => (confirmed, UnmodelledErrors::default()),
        false => reject_replaceable_causes(problem, confirmed)?,
    };
    let ConfirmedCauses {
        inference,
        posteriors,
        mut possible,
        ..
    } = confirmed;
    report.stage(Stage::HeldOut, findings.len());
    let fit = &inference.fit;
    let unseen = unseen_beside(&inference);
    let sd_ratios = inference.sd_ratios();
    let mut before = Prediction::new(&Fit::new(problem, &[])?);
    for (index, posterior) in posteriors.iter().enumerate() {
        let after = Prediction::new(&Fit::new(problem, &fit.causes[..=index])?);
        let gain = after.gain_over(&before);
        before = after;
        report.stage(Stage::Separation, findings.len());
        let found = FindingBuilder {
            fit,
            index,
            posterior,
            gain,
            questions: visibility.len(),
            sd_ratios: &sd_ratios[index],
        };
        findings.push(found.build()?);
    }
    report.stage(Stage::Discrepancy, findings.len());
    let (mut base, discrepancies, _) = assess_fit(first, options.alpha);
    let (extended, remaining, space) = assess_fit(fit, options.alpha);
    // Nothing is named by a fit that did not converge or is worse than the one without causes.
    let is_better = fit.solution.converged() && extended.global.chi2 <= base.global.chi2;
    let mut noise = noise_statements(&space, &remaining, options.alpha);
    // The noise of means is smaller than that of single rows by a factor that depends on what the rows share, so less
    // noise than described is not reported for them.
    noise.retain(|statement| rows == 1 || statement.ratio > 1.0);
    if !report.cancelled {
        let mut remaining_errors = unmodelled.remaining;
        if remaining_errors.is_empty() {
            remaining_errors.extend(remaining.first().map(WeighedError::from_discrepancy));
        }
        let of_errors = allow_for_errors(&mut findings, &inference, &unmodelled.rivals, &space);
        state_probabilities(&mut findings, &inference, &posteriors, &of_errors);
        findings.extend(remaining_errors.iter().map(|s| s.finding(fit)));
        possible = stated_causes(possible);
    }
    findings.retain(|finding| is_better || finding.cause().is_none());
    base.adequate &= findings.is_empty();
    let (extended, fit) = match is_better {
        true => (extended, fit),
        false => (base.clone(), first),
    };
    let (invisible, readable) = invisible_effects(problem, &visibility, options);
    Ok(Diagnosis {
        noise,
        base,
        extended,
        discrepancies,
        remaining,
        invisible,
        readable,
        findings,
        possible,
        sets,
        unseen,
        tolerances: ToleranceFactor {
            factor: inference.tolerance_factor(),
            are_stated: false,
        },
        held: first.problem.held_effects.len(),
        base_solution: first.solution.clone(),
        extended_solution: fit.solution.clone(),
        cancelled: report.cancelled,
    })
}

/// Faults that the readings do not exclude beside the causes of an inference.
fn unseen_beside(inference: &Inference<'_>) -> Vec<UnseenFault> {
    let at = LinearFit::new(&inference.fit, true);
    let gram = at.gram_beside_present(&inference.hyper);
    let present: Vec<usize> = at.present.iter().map(|member| member.0).collect();
    unseen_faults(&gram, &present)
}

/// The problem of a fit without causes, with the deviations of the parts estimated, whose priors are the tolerances times a factor.
fn with_deviations<'a>(fit: &Fit<'a>, factor: f64) -> Problem<'a> {
    let columns = fit.deviation_columns();
    let visible = columns
        .visible
        .iter()
        .map(|deviation| deviation.scaled(factor));
    fit.base().clone().with_deviations(visible.collect())
}

/// The inference with the deviations of `problem` in the nonlinear fit, too, so that the sizes of the causes and all that is
/// reported allow for them. The sets are compared without them, because they are small enough for a linear problem.
fn infer_with_deviations<'a>(
    factor: f64,
    inference: Inference<'a>,
) -> Result<(Problem<'a>, Inference<'a>), EstimationError> {
    let mut problem = with_deviations(&inference.fit, factor);
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
