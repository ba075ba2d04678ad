//! No name with confidence where much remains unexplained: what is left may be the true cause, and a name that explains
//! less than that only its shadow.

use super::fit::Fit;
use super::gain::Prediction;
use super::report::{Alternative, Cause, Discrepancy, Evidence, Finding, NoiseStatement, Quantity, Verdict};
use super::unknown::{is_unknown, structure_on};
use crate::effect::Search;
use crate::robot::Robot;

/// Events on one reading from which they look like a pattern.
const MANY_EVENTS: usize = 3;
/// Gain of chi-square from which an event stands for itself.
const LARGE_EVENT: f64 = 60.0;

/// What a model leaves unexplained.
pub(super) struct Left<'l> {
    /// The fit with all causes, in the noise given.
    pub fit: &'l Fit<'l>,
    /// Level of the global test.
    pub alpha: f64,
    pub discrepancies: &'l [Discrepancy],
    pub noise: &'l [NoiseStatement],
}

impl Left<'_> {
    /// Chi-square beyond what noise gives; 0 where that is no more than chance.
    fn excess(&self) -> f64 {
        let solution = &self.fit.solution;
        let beyond = solution.p_value().is_some_and(|p| p < self.alpha);
        if beyond {
            solution.chi2 - solution.degrees_of_freedom
        } else {
            0.0
        }
    }
}

/// Takes the confidence from names that what is left, or structure without a name, could be behind; adds what is
/// left as a finding if nothing else stands for it.
pub(super) fn temper(findings: &mut Vec<Finding>, left: &Left<'_>) {
    let excess = left.excess();
    let doubtful: Vec<bool> = (0..findings.len())
        .map(|index| is_doubtful(findings, index, excess))
        .collect();
    let cables = left.fit.problem.dataset.robot.cable_count();
    for (finding, _) in findings.iter_mut().zip(&doubtful).filter(|(_, d)| **d) {
        let quantity = Quantity::Length;
        let cable = finding.cause.cables().first().copied();
        let known = finding.alternatives.iter().any(|a| is_unknown(&a.cause));
        if !known {
            finding.alternatives.truncate(1);
            // Either may be behind it: as likely as not.
            finding.probability = 0.5;
            finding.alternatives.push(Alternative {
                cause: Cause {
                    instances: vec![structure_on(quantity, cable, cables)],
                },
                probability: 0.5,
            });
        }
        finding.verdict = Verdict::Ambiguous;
    }
    let stands = findings.iter().any(|f| f.verdict == Verdict::Unknown);
    if excess > 0.0 && !stands {
        findings.extend(rest(left));
    }
}

fn is_doubtful(findings: &[Finding], index: usize, excess: f64) -> bool {
    let finding = &findings[index];
    if is_unknown(&finding.cause) {
        return false;
    }
    let gain = finding.evidence.delta_chi2;
    let behind = |other: &Finding| {
        is_unknown(&other.cause)
            && other.evidence.delta_chi2 > gain
            && overlap(&other.cause, &finding.cause)
    };
    let is_small_event = |other: &Finding| {
        is_event(&other.cause)
            && other.evidence.delta_chi2 < LARGE_EVENT
            && other.cause.cables() == finding.cause.cables()
    };
    let events = findings.iter().filter(|f| is_small_event(f)).count();
    gain < excess || findings.iter().any(behind) || is_small_event(finding) && events >= MANY_EVENTS
}

fn is_event(cause: &Cause) -> bool {
    matches!(
        cause.effect().search(),
        Search::AtPose(_) | Search::FromPose(_)
    )
}

/// Whether two causes concern the same cable; what concerns no cable in particular concerns all.
fn overlap(one: &Cause, other: &Cause) -> bool {
    let (one, other) = (one.cables(), other.cables());
    one.is_empty() || other.is_empty() || one.iter().any(|cable| other.contains(cable))
}

/// What is left, as a finding: the strongest dependence, or else readings that scatter too much.
fn rest(left: &Left<'_>) -> Option<Finding> {
    let robot = &left.fit.problem.dataset.robot;
    if let Some(found) = left.discrepancies.first() {
        let what = reading_of(found.quantity, found.cable, robot);
        let variable = found.variable.name();
        let sentence = format!(
            "The {what} have an error that depends on the {variable}; no known cause explains it."
        );
        return Some(nameless(
            left,
            (found.quantity, found.cable),
            sentence,
            found.p_value,
        ));
    }
    let loud = left.noise.iter().find(|statement| statement.ratio > 1.0)?;
    let what = reading_of(loud.quantity, loud.cable, robot);
    let sentence = format!(
        "The {what} scatter {:.1} times as much as given, without a pattern.",
        loud.ratio
    );
    Some(nameless(
        left,
        (loud.quantity, loud.cable),
        sentence,
        loud.p_value,
    ))
}

fn reading_of(quantity: Quantity, cable: Option<usize>, robot: &Robot) -> String {
    match cable {
        Some(cable) => format!(
            "{} readings of {}",
            quantity.name(),
            robot.cables[cable].name
        ),
        None => format!("{} readings", quantity.name()),
    }
}

fn nameless(
    left: &Left<'_>,
    (quantity, cable): (Quantity, Option<usize>),
    sentence: String,
    p_value: f64,
) -> Finding {
    let prediction = Prediction::new(left.fit);
    let cables = left.fit.problem.dataset.robot.cable_count();
    Finding {
        verdict: Verdict::Unknown,
        cause: Cause {
            instances: vec![structure_on(quantity, cable, cables)],
        },
        probability: 1.0 - p_value,
        sentence,
        advice: "Measure one pose many times: if the readings scatter as much there, correct the noise given; else look for a fault that comes and goes.".to_owned(),
        alternatives: Vec::new(),
        parameters: Vec::new(),
        evidence: Evidence {
            delta_chi2: 0.0,
            parameters: 0,
            p_value,
            questions: 0,
            ranking: Vec::new(),
        },
        gain: prediction.gain_over(&prediction),
        separation: None,
    }
}
