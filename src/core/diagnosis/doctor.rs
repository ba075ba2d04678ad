//! The course of a diagnosis.

use super::adequacy::adequacy;
use super::candidates::size_parameter;
use super::claims::{Claim, claims};
use super::discrepancy::{dependence_tests, discrepancies};
use super::exchange::exchanged;
use super::finding::Found;
use super::fit::Fit;
use super::gain::Prediction;
use super::inference::{Inference, Visibility, at_fit, infer};
use super::noise::noise_statements;
use super::progress::Reporter;
use super::reading_id::ReadingId;
use super::remainder::{Structure, structures};
use super::report::{
    Adequacy, Alternative, Cause, Diagnosis, Discrepancy, Finding, Invisible, Verdict,
};
use super::residual_space::ResidualSpace;
use super::variables::Variables;
use super::{DiagnosisOptions, Observer, Quantity, Stage};
use crate::effect::{CablePorts, Dual, Search, measurements_as_modelled};
use crate::estimation::{EstimationError, Linearisation, Problem};
use crate::measurement::Dataset;
use crate::statistics::normal_quantile;

/// Probability with which an effect of the smallest visible size is found.
const POWER: f64 = 0.9;
/// Part of what a cause explains that may be left without a name in the readings of the same cables.
const LEFT: f64 = 0.5;
/// Events on one reading from which they look like a pattern, unless each stands for itself by this gain.
const MANY_EVENTS: usize = 2;
const LARGE_EVENT: f64 = 60.0;

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
pub(super) fn based(dataset: &Dataset) -> Result<Problem<'_>, EstimationError> {
    let problem = Problem::new(dataset)?;
    let first = Fit::new(&problem, &[])?;
    Ok(problem.at_poses_of(&first.solution))
}

fn examine(
    problem: &Problem<'_>,
    first: &Fit<'_>,
    mut findings: Vec<Finding>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<Diagnosis, EstimationError> {
    let (inference, visibility) = infer(problem, options, report)?;
    let (claims, possible) = claims(&inference.ranking);
    let (inference, claims, possible) = kept(problem, inference, claims, possible, options)?;
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
    if !report.cancelled {
        let mut left = structures(&inference);
        if left.is_empty() {
            left.extend(remaining.first().map(Structure::of_discrepancy));
        }
        let scatter = excess(&inference, &remaining);
        temper(&mut findings, (&left, &scatter), fit);
        findings.extend(left.iter().map(|s| s.finding(fit, &remaining)));
    }
    base.adequate &= findings.is_empty();
    Ok(Diagnosis {
        noise: noise_statements(&space, &remaining, options.alpha),
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

/// The causes that are there with near certainty and predict poses held out, fitted without the others; these are
/// possible.
fn kept<'a>(
    problem: &Problem<'a>,
    inference: Inference<'a>,
    claims: Vec<Claim>,
    mut possible: Vec<Alternative>,
    options: &DiagnosisOptions,
) -> Result<(Inference<'a>, Vec<Claim>, Vec<Alternative>), EstimationError> {
    let full = Prediction::new(&inference.fit);
    let mut kept: Vec<(f64, Cause, Claim)> = Vec::new();
    for (index, (cause, claim)) in inference.fit.causes.iter().zip(claims).enumerate() {
        let mut others = inference.fit.causes.clone();
        others.remove(index);
        let without = Fit::new(problem, &others)?;
        if claim.is_sure && full.is_better_than(&Prediction::new(&without)) {
            kept.push((without.solution.chi2, cause.clone(), claim));
        } else {
            possible.push(Alternative {
                cause: cause.clone(),
                probability: claim.probability,
            });
            possible.extend(claim.alternatives);
        }
    }
    possible.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let is_complete = kept.len() == inference.fit.causes.len();
    let is_ordered = kept.windows(2).all(|pair| pair[0].0 >= pair[1].0);
    // What explains most comes first.
    kept.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (causes, claims): (Vec<_>, Vec<_>) = kept
        .into_iter()
        .map(|(_, cause, claim)| (cause, claim))
        .unzip();
    if is_complete && is_ordered {
        return Ok((inference, claims, possible));
    }
    let ordered = at_fit(Fit::new(problem, &causes)?, options, Vec::new());
    Ok((ordered, claims, possible))
}

/// Takes the confidence from names that structure without a name could be behind.
fn temper(
    findings: &mut [Finding],
    (left, scatter): (&[Structure], &[(ReadingId, f64)]),
    fit: &Fit<'_>,
) {
    let cables = fit.problem.dataset.robot.cable_count();
    let many = |finding: &Finding, all: &[Finding]| {
        let small = |f: &&Finding| {
            let at_pose = matches!(f.cause.effect().search(), Search::AtPose(_));
            at_pose
                && f.evidence.delta_chi2 < LARGE_EVENT
                && f.cause.cables() == finding.cause.cables()
        };
        small(&finding) && all.iter().filter(small).count() >= MANY_EVENTS
    };
    let events: Vec<bool> = findings.iter().map(|f| many(f, findings)).collect();
    for (finding, is_event) in findings.iter_mut().zip(events) {
        let own = finding.cause.cables();
        let behind = left.iter().find(|structure| {
            let same = own.is_empty() || structure.id.cable.is_none_or(|c| own.contains(&c));
            same && 2.0 * structure.log_evidence > LEFT * finding.evidence.delta_chi2
        });
        let mut beside = scatter.iter();
        let scattered = beside.find(|(id, excess)| {
            let same = own.is_empty() || id.cable.is_none_or(|c| own.contains(&c));
            same && *excess > LEFT * finding.evidence.delta_chi2
        });
        let other = match (behind, scattered) {
            (Some(structure), _) => structure.cause(cables),
            (None, Some((id, _))) => Structure::of(*id).cause(cables),
            (None, None) if is_event => {
                let id = ReadingId {
                    quantity: Quantity::Length,
                    cable: own.first().copied(),
                    component: None,
                };
                Structure::of(id).cause(cables)
            }
            (None, None) => continue,
        };
        finding.verdict = Verdict::Ambiguous;
        // Which of them is behind what they share is open.
        finding.probability *= 0.5;
        finding.alternatives.truncate(1);
        finding.alternatives.push(Alternative {
            cause: other,
            probability: finding.probability,
        });
    }
}

/// Chi-square of readings that depend on something, beyond what noise gives, and of the readings of each cable beyond that
/// of the same readings of other cables.
fn excess(inference: &Inference<'_>, remaining: &[Discrepancy]) -> Vec<(ReadingId, f64)> {
    let structured = remaining.iter().map(|d| {
        let excess = d.points.len() as f64 * (d.rms_over_sd.powi(2) - 1.0);
        (Structure::of_discrepancy(d).id, excess)
    });
    let conditions = &inference.linear.conditions;
    let of = |class: usize| {
        let id = conditions.classes[class];
        let same = conditions.classes.iter().enumerate();
        let others = same.filter(|(k, other)| *k != class && other.quantity == id.quantity);
        let mut variances: Vec<f64> = others.map(|(k, _)| inference.at.variance[k]).collect();
        variances.sort_by(f64::total_cmp);
        let usual = variances
            .get(variances.len() / 2)
            .copied()
            .unwrap_or(f64::INFINITY);
        let readings = conditions.poses_of(class).len() as f64;
        (id, readings * (inference.at.variance[class] - usual))
    };
    let classes = 0..conditions.classes.len();
    structured.chain(classes.map(of)).collect()
}

/// Whether a fit explains the data, and if not, on what its residuals depend.
fn judged(fit: &Fit<'_>, alpha: f64) -> (Adequacy, Vec<Discrepancy>, ResidualSpace) {
    // Half of the probability of a false alarm is for the tests of the residuals, half for the causes.
    let level = alpha / 2.0;
    let linear = Linearisation::new(&fit.problem, &fit.solution);
    let space = ResidualSpace::new(&linear);
    let variables = Variables::new(&fit.problem, &fit.solution, &linear);
    let tests = dependence_tests(&space, &variables);
    let found = discrepancies(&space, &tests, level);
    (adequacy(&space, &fit.solution, level), found, space)
}

/// The effects that would not be found at their largest typical size, of those on which a reading depends at all: what an
/// instrument shows that was not there is nobody's question.
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

/// Whether it changes the tensions that force sensors tell.
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
