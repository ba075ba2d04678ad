//! The course of a diagnosis.

use super::adequacy::adequacy;
use super::discrepancy::{dependence_tests, discrepancies};
use super::exchange::exchanged;
use super::fit::Fit;
use super::gain::Prediction;
use super::honesty::{Left, temper};
use super::noise::{freedom_of, noise_statements, with_noise};
use super::progress::Reporter;
use super::report::{Adequacy, Cause, Diagnosis, Discrepancy, Finding, Invisible, NoiseStatement};
use super::residual_space::ResidualSpace;
use super::scores::{Scan, Scored};
use super::selection::{Selection, select};
use super::variables::Variables;
use super::verdict::finding;
use super::{DiagnosisOptions, Observer, Stage};
use crate::effect::{CablePorts, Dual, Search, measurements_as_modelled};
use crate::estimation::{EstimationError, Linearisation, Problem};
use crate::measurement::Dataset;
use crate::statistics::normal_quantile;

/// Probability with which an effect of the smallest visible size is found.
const POWER: f64 = 0.9;

/// Diagnoses a dataset: the joint problem of its robot, the effects of its model held.
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
    let dataset = Dataset {
        robot: dataset.robot.clone(),
        measurements: measurements.into_owned(),
    };
    let problem = based(&dataset)?;
    let first = Fit::new(&problem, &[])?;
    let Some(exchange) = exchanged(&first, &mut report)? else {
        return examine(&problem, &first, Vec::new(), options, &mut report);
    };
    let mut after = based(&exchange.dataset)?;
    after.held_effects.push(exchange.bound.clone());
    let second = Fit::new(&after, &[])?;
    let found = exchange.finding(&first, &second);
    examine(&after, &first, vec![found], options, &mut report)
}

/// The problem with what effects depend on taken at the poses of its solution.
fn based(dataset: &Dataset) -> Result<Problem<'_>, EstimationError> {
    let problem = Problem::new(dataset)?;
    let first = Fit::new(&problem, &[])?;
    Ok(problem.at_poses_of(&first.solution))
}

fn examine(
    problem: &Problem<'_>,
    first: &Fit<'_>,
    found: Vec<Finding>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Diagnosis, EstimationError> {
    // Half of the probability of a false alarm is for the tests of the residuals, half for the causes.
    let level = DiagnosisOptions {
        alpha: options.alpha / 2.0,
        ..*options
    };
    let selection = select(problem, &level, report)?;
    let Some(noise) = louder_noise(problem, &selection, level.alpha)? else {
        let noise = noise_of(&selection.fit, level.alpha).1;
        let full = selection.fit.clone();
        return conclude(&selection, (first, &full, noise), found, &level, report);
    };
    // Noise that is larger than given makes chance look like causes: ask again with the noise that there is.
    let louder = with_noise(problem.dataset, &noise);
    let louder = based_like(problem, &louder)?;
    let selection = select(&louder, &level, report)?;
    let full = Fit::new(problem, &selection.fit.causes)?;
    conclude(&selection, (first, &full, noise), found, &level, report)
}

/// The noise that explains the data better than the weaker ones of the selected causes do: what is compared is the
/// restricted likelihood, chi-square and the logarithms of the variances, for the strongest causes alone, the
/// strongest two, and so on, each with the noise that it leaves.
fn louder_noise(
    problem: &Problem<'_>,
    selection: &Selection<'_>,
    alpha: f64,
) -> Result<Option<Vec<NoiseStatement>>, EstimationError> {
    let causes = selection.by_strength();
    let mut best: Option<(f64, Vec<NoiseStatement>)> = None;
    let mut freedom = 0.0;
    for count in 0..=causes.len() {
        let chosen: Vec<Cause> = causes[..count]
            .iter()
            .map(|(cause, _)| cause.clone())
            .collect();
        freedom += count.checked_sub(1).map_or(0.0, |last| causes[last].1);
        let fit = Fit::new(problem, &chosen)?;
        let (space, mut noise) = noise_of(&fit, alpha);
        noise.retain(|statement| statement.ratio > 1.0);
        let mut loss = fit.solution.chi2 + freedom;
        if !noise.is_empty() {
            let louder = with_noise(problem.dataset, &noise);
            let fit = Fit::new(&based_like(problem, &louder)?, &chosen)?;
            let price = selection.first.price() * noise.len() as f64;
            let variances = noise
                .iter()
                .map(|s| freedom_of(&space, s) * 2.0 * s.ratio.ln());
            loss = fit.solution.chi2 + freedom + price + variances.sum::<f64>();
        }
        if best.as_ref().is_none_or(|(least, _)| loss < *least) {
            best = Some((loss, noise));
        }
    }
    let noise = best.map(|(_, noise)| noise).unwrap_or_default();
    // Without causes there is nothing to ask again.
    Ok((!noise.is_empty() && !causes.is_empty()).then_some(noise))
}

/// The same problem with another dataset.
fn based_like<'d>(
    problem: &Problem<'_>,
    dataset: &'d Dataset,
) -> Result<Problem<'d>, EstimationError> {
    let mut same = based(dataset)?;
    same.held_effects.clone_from(&problem.held_effects);
    Ok(same)
}

/// What a selection means; `first` is the fit of the model as it came, `full` that of the extended one in the noise
/// given, `noise` what is said of the noise.
fn conclude(
    selection: &Selection<'_>,
    (first, full, noise): (&Fit<'_>, &Fit<'_>, Vec<NoiseStatement>),
    mut findings: Vec<Finding>,
    level: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Diagnosis, EstimationError> {
    report.stage(Stage::HeldOut, selection.fit.causes.len());
    let mut before = Prediction::new(&selection.base);
    for index in 0..selection.fit.causes.len() {
        let fit = Fit::new(&selection.base.problem, &selection.fit.causes[..=index])?;
        let after = Prediction::new(&fit);
        let gain = after.gain_over(&before);
        report.stage(Stage::Separation, findings.len());
        findings.extend(finding(selection, index, gain, level));
        before = after;
    }
    report.stage(Stage::Discrepancy, findings.len());
    let (mut base, discrepancies) = judged(first, level.alpha);
    let (extended, remaining) = judged(full, level.alpha);
    let left = Left {
        fit: full,
        alpha: level.alpha,
        discrepancies: &remaining,
        noise: &noise,
    };
    if !report.cancelled {
        temper(&mut findings, &left);
    }
    base.adequate &= findings.is_empty();
    Ok(Diagnosis {
        base,
        possible: Vec::new(),
        noise,
        extended,
        discrepancies,
        remaining,
        invisible: invisible(selection, level),
        findings,
        base_solution: first.solution.clone(),
        extended_solution: selection.fit.solution.clone(),
        cancelled: report.cancelled,
    })
}

/// The residuals of a fit, and on what they depend.
fn residuals(fit: &Fit<'_>, alpha: f64) -> (ResidualSpace, Vec<Discrepancy>) {
    let linear = Linearisation::new(&fit.problem, &fit.solution);
    let space = ResidualSpace::new(&linear);
    let variables = Variables::new(&fit.problem, &fit.solution, &linear);
    let tests = dependence_tests(&space, &variables);
    let found = discrepancies(&space, &tests, alpha);
    (space, found)
}

/// Whether a fit explains the data, and if not, on what its residuals depend.
fn judged(fit: &Fit<'_>, alpha: f64) -> (Adequacy, Vec<Discrepancy>) {
    let (space, found) = residuals(fit, alpha);
    (adequacy(&space, &fit.solution, alpha), found)
}

/// The residuals of a fit, and what they say of the noise.
fn noise_of(fit: &Fit<'_>, alpha: f64) -> (ResidualSpace, Vec<NoiseStatement>) {
    let (space, structure) = residuals(fit, alpha);
    let noise = noise_statements(&space, &structure, alpha);
    (space, noise)
}

/// The effects that would not be found at their largest typical size, of those on which a reading depends at all: what an
/// instrument shows that was not there is nobody's question.
fn invisible(selection: &Selection<'_>, options: &DiagnosisOptions) -> Vec<Invisible> {
    let scan: &Scan = &selection.first;
    let tail = options.alpha / (2.0 * scan.questions.max(1) as f64);
    let needed = normal_quantile(1.0 - tail) + normal_quantile(POWER);
    let single = |s: &&Scored| s.cause.instances.len() == 1;
    let problem = &selection.fit.problem;
    // Only columns of zeros gain exactly nothing.
    let is_read =
        |s: &&Scored| s.gain != 0.0 && (has_forces(problem) || !acts_on_tension(s, problem));
    let asked = scan.scored.iter().filter(single).filter(is_read);
    let mut found = Vec::new();
    for scored in asked {
        let effect = scored.cause.effect();
        let index = match effect.search() {
            Search::Wave { phase, period } => (0..3).find(|k| *k != phase && Some(*k) != period),
            _ => effect.parameters().iter().position(|p| !p.discrete),
        };
        let Some(parameter) = index.map(|k| &effect.parameters()[k]) else {
            continue;
        };
        let smallest = scored.sd.map(|sd| needed * sd);
        if smallest.is_none_or(|size| size > parameter.typical[1]) {
            found.push(Invisible {
                cause: Cause {
                    instances: scored.cause.instances.clone(),
                },
                parameter: (parameter.name, parameter.unit),
                smallest_visible: smallest,
            });
        }
    }
    found
}

fn has_forces(problem: &Problem<'_>) -> bool {
    let forces = &problem.dataset.measurements.force_n;
    !forces.is_empty() && problem.dataset.robot.has_force_sensors()
}

/// Whether it changes the tensions that force sensors tell.
fn acts_on_tension(scored: &Scored, problem: &Problem<'_>) -> bool {
    let bound = &scored.cause.instances[0];
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
