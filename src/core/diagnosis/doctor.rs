//! The course of a diagnosis.

use super::adequacy::adequacy;
use super::candidates::size_parameter;
use super::claims::{Claim, SURE, claims};
use super::discrepancy::{dependence_tests, discrepancies};
use super::exchange::exchanged;
use super::exploration::Visibility;
use super::finding::Found;
use super::fit::Fit;
use super::gain::Prediction;
use super::inference::{Inference, at_fit, infer};
use super::noise::noise_statements;
use super::progress::Reporter;
use super::reading_id::ReadingId;
use super::remainder::{Nameless, Remainder};
use super::report::{
    Adequacy, Alternative, Cause, Diagnosis, Discrepancy, Finding, Invisible, NoiseStatement,
    Verdict,
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
/// Part of what a cause explains by which readings of the same cables may scatter more than those of others.
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
    let kept = kept(problem, inference, claims, possible, options)?;
    let (inference, claims, possible, remainder) = contested(problem, kept, options)?;
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
    let noise = noise_statements(&space, &remaining, options.alpha);
    if !report.cancelled {
        let mut left = remainder.left;
        if left.is_empty() {
            left.extend(remaining.first().map(Nameless::of_discrepancy));
        }
        let scatter = excess(&space, &remaining, &noise);
        temper(&mut findings, &remainder.rivals, &scatter, fit);
        findings.extend(left.iter().map(|s| s.finding(fit)));
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

/// Causes with what is known of them, and what else is possible.
type Kept<'a> = (Inference<'a>, Vec<Claim>, Vec<Alternative>);

/// Leaves out the causes in whose place an error without a name is nearly certain, until none is.
fn contested<'a>(
    problem: &Problem<'a>,
    (mut inference, mut claims, mut possible): Kept<'a>,
    options: &DiagnosisOptions,
) -> Result<(Inference<'a>, Vec<Claim>, Vec<Alternative>, Remainder), EstimationError> {
    let mut lost: Vec<Nameless> = Vec::new();
    loop {
        let mut remainder = Remainder::new(&inference);
        let mut causes = Vec::new();
        let mut kept = Vec::new();
        let all = inference.fit.causes.iter().zip(claims);
        for ((cause, claim), rival) in all.zip(&remainder.rivals) {
            match rival.as_ref().filter(|rival| rival.probability() >= SURE) {
                Some(rival) => {
                    possible.push(Alternative {
                        cause: cause.clone(),
                        probability: claim.probability * (1.0 - rival.probability()),
                    });
                    lost.push(rival.clone());
                }
                None => {
                    causes.push(cause.clone());
                    kept.push(claim);
                }
            }
        }
        claims = kept;
        if causes.len() == inference.fit.causes.len() {
            for rival in lost {
                if remainder.left.iter().all(|known| known.id != rival.id) {
                    remainder.left.push(rival);
                }
            }
            return Ok((inference, claims, possible, remainder));
        }
        inference = at_fit(Fit::new(problem, &causes)?, options, Vec::new());
    }
}

/// The causes that are there with near certainty and predict poses held out, fitted without the others; these are
/// possible.
fn kept<'a>(
    problem: &Problem<'a>,
    inference: Inference<'a>,
    claims: Vec<Claim>,
    mut possible: Vec<Alternative>,
    options: &DiagnosisOptions,
) -> Result<Kept<'a>, EstimationError> {
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

/// Takes the confidence from names in whose place an error without a name could be.
fn temper(
    findings: &mut [Finding],
    rivals: &[Option<Nameless>],
    scatter: &[(ReadingId, f64)],
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
    // Exchanged channels come first and have no rivals.
    let first = findings.len() - rivals.len();
    for (index, (finding, is_event)) in findings.iter_mut().zip(events).enumerate() {
        let own = finding.cause.cables();
        let rival = index.checked_sub(first).and_then(|k| rivals[k].as_ref());
        let rival = rival.filter(|r| finding.probability * (1.0 - r.probability()) < SURE);
        let mut beside = scatter.iter();
        let scattered = beside.find(|(id, excess)| {
            let same = id.cable.is_none_or(|c| own.contains(&c));
            same && *excess > LEFT * finding.evidence.delta_chi2
        });
        let lengths = ReadingId {
            quantity: Quantity::Length,
            cable: own.first().copied(),
            component: None,
        };
        let (other, share) = match (rival, scattered) {
            (Some(rival), _) => (rival.clone(), rival.probability()),
            // Which of them is behind what they share is open.
            (None, Some((id, _))) => (Nameless::of(*id), 0.5),
            (None, None) if is_event => (Nameless::of(lengths), 0.5),
            (None, None) => continue,
        };
        finding.verdict = Verdict::Ambiguous;
        finding.alternatives.truncate(1);
        finding.alternatives.push(Alternative {
            cause: other.cause(cables),
            probability: finding.probability * share,
        });
        finding.probability *= 1.0 - share;
    }
}

/// Chi-square of readings that depend on something, and of the readings of a cable that scatter more than those of others,
/// beyond what noise gives.
fn excess(
    space: &ResidualSpace,
    remaining: &[Discrepancy],
    noise: &[NoiseStatement],
) -> Vec<(ReadingId, f64)> {
    let structured = remaining.iter().map(|d| {
        let excess = d.points.len() as f64 * (d.rms_over_sd.powi(2) - 1.0);
        (Nameless::of_discrepancy(d).id, excess)
    });
    let loud = noise.iter().filter(|statement| statement.cable.is_some());
    let loud = loud.map(|statement| {
        let id = ReadingId {
            quantity: statement.quantity,
            cable: statement.cable,
            component: None,
        };
        let readings = space.readings.iter().filter(|r| **r == Some(id)).count();
        (id, readings as f64 * (statement.ratio.powi(2) - 1.0))
    });
    structured.chain(loud).collect()
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
