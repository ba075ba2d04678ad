//! The sequence of steps of a diagnosis.

use super::candidates::size_parameter;
use super::claims::{claims, possible_after};
use super::confidence::{
    Kept, allow_for_imitations, contested, excess, judged, kept, temper, weighed,
};
use super::exchange::exchanged;
use super::exploration::Visibility;
use super::finding::Found;
use super::fit::Fit;
use super::gain::Prediction;
use super::inference::infer;
use super::noise::noise_statements;
use super::progress::Reporter;
use super::remainder::Nameless;
use super::report::{Diagnosis, Finding, Invisible};
use super::{DiagnosisOptions, Observer, Stage};
use crate::effect::{CablePorts, Dual, measurements_as_modelled};
use crate::estimation::{EstimationError, Problem};
use crate::measurement::Dataset;
use crate::statistics::normal_quantile;

/// Probability of detection at the smallest visible size.
const POWER: f64 = 0.9;

/// Maximum number of samples taken from a recording in motion.
pub const MOST_SAMPLES: usize = 300;

/// Diagnoses a dataset with the joint problem of its robot, the effects of its model held fixed. Rows of one standstill
/// are averaged, and recordings in motion are thinned to independent samples.
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
    let (averaged, rows) = measurements.independent(&dataset.robot, MOST_SAMPLES);
    let dataset = Dataset {
        robot: dataset.robot.clone(),
        measurements: averaged.into_owned(),
    };
    let problem = based(&dataset)?;
    let first = Fit::new(&problem, &[])?;
    let Some(exchange) = exchanged(&first, &mut report)? else {
        return examine(&problem, (&first, rows), Vec::new(), options, &mut report);
    };
    let mut after = based(&exchange.dataset)?;
    after.held_effects.push(exchange.bound.clone());
    let second = Fit::new(&after, &[])?;
    let found = exchange.finding(&first, &second);
    examine(&after, (&first, rows), vec![found], options, &mut report)
}

/// The problem whose effects are evaluated at the poses of its own solution.
pub(super) fn based(dataset: &Dataset) -> Result<Problem<'_>, EstimationError> {
    let problem = Problem::new(dataset)?;
    let first = Fit::new(&problem, &[])?;
    Ok(problem.at_poses_of(&first.solution))
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
    let problem = &problem;
    let (claims, possible) = claims(&inference.ranking);
    let kept = kept(problem, inference, claims, possible, options)?;
    let contested = contested(problem, kept, options)?;
    let (kept, remainder) = weighed(problem, contested, options)?;
    let Kept {
        inference,
        claims,
        mut possible,
        ..
    } = kept;
    report.stage(Stage::HeldOut, findings.len());
    let fit = &inference.fit;
    let spread = inference.spread();
    let mut before = Prediction::new(&Fit::new(problem, &[])?);
    for (index, claim) in claims.iter().enumerate() {
        let after = Prediction::new(&Fit::new(problem, &fit.causes[..=index])?);
        let gain = after.gain_over(&before);
        before = after;
        report.stage(Stage::Separation, findings.len());
        let found = Found {
            fit,
            index,
            claim,
            gain,
            questions: visibility.len(),
            spread: &spread[index],
        };
        findings.push(found.finding()?);
    }
    report.stage(Stage::Discrepancy, findings.len());
    let (mut base, discrepancies, _) = judged(first, options.alpha);
    let (extended, remaining, space) = judged(fit, options.alpha);
    let mut noise = noise_statements(&space, &remaining, options.alpha);
    // The noise of means is smaller than that of single rows by a factor that depends on what the rows share, so less
    // noise than described is not reported for them.
    noise.retain(|statement| rows == 1 || statement.ratio > 1.0);
    if !report.cancelled {
        let mut left = remainder.left;
        if left.is_empty() {
            left.extend(remaining.first().map(Nameless::of_discrepancy));
        }
        let scatter = excess(&space, &remaining, &noise);
        temper(
            &mut findings,
            &inference,
            (&remainder.rivals, &left),
            &scatter,
        );
        allow_for_imitations(&mut findings);
        findings.extend(left.iter().map(|s| s.finding(fit)));
        possible = possible_after(possible, !left.is_empty());
    }
    base.adequate &= findings.is_empty();
    Ok(Diagnosis {
        noise,
        base,
        extended,
        discrepancies,
        remaining,
        invisible: invisible(problem, &visibility, options),
        findings,
        possible,
        base_solution: first.solution.clone(),
        extended_solution: fit.solution.clone(),
        cancelled: report.cancelled,
    })
}

/// Effects that would not be found even at their largest typical size. Effects of instruments that the robot does not
/// have are left out.
fn invisible(
    problem: &Problem<'_>,
    visibility: &[Visibility],
    options: &DiagnosisOptions,
) -> Vec<Invisible> {
    let tail = options.alpha / (2.0 * visibility.len().max(1) as f64);
    let needed = normal_quantile(1.0 - tail) + normal_quantile(POWER);
    let has_forces = problem.dataset.robot.has_force_sensors()
        && !problem.dataset.measurements.force_n.is_empty();
    let mut found = Vec::new();
    for asked in visibility {
        let is_read = asked.is_read && (has_forces || !acts_on_tension(asked, problem));
        let Some(parameter) = size_parameter(asked.cause.effect()).filter(|_| is_read) else {
            continue;
        };
        let smallest = asked.sd.map(|sd| needed * sd);
        if smallest.is_none_or(|size| size > parameter.typical[1]) {
            found.push(Invisible {
                cause: asked.cause.clone(),
                parameter: (parameter.name, parameter.unit),
                smallest_visible: smallest,
            });
        }
    }
    found
}

/// Whether an effect acts only through tensions that force sensors read.
fn acts_on_tension(asked: &Visibility, problem: &Problem<'_>) -> bool {
    let bound = &asked.cause.instances[0];
    let (Some(cable), Some(contexts)) = (bound.cables.first(), &problem.contexts) else {
        return false;
    };
    let robot = &problem.dataset.robot;
    let values: Vec<Dual> = bound.values.iter().map(|v| Dual::variable(*v)).collect();
    (0..problem.dataset.measurements.len()).any(|row| {
        let mut ports = CablePorts::nominal(&robot.cables[*cable], 0.0, 1.0);
        let at = contexts.cable(row, *cable);
        (bound.effect.change_cable)(&values, at, &mut ports);
        ports.tension.slope != 0.0
    })
}
