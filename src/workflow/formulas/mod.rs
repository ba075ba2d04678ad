//! Formulas for unexplained errors, from a small grammar and weighed by the evidence of the model doctor.
//!
//! Each formula is a hypothesis, as a user would write one; the doctor weighs them beside the catalogue. A formula is a pattern,
//! never a cause: a person names it.

mod document;
mod grammar;

use std::cmp::Ordering;
use std::collections::HashMap;
use std::sync::Arc;

use tautline_core::diagnosis::{DiagnosisProgress, Subject};
use tautline_core::effect::{Hypothesis, MAX_HYPOTHESES};
use tautline_core::estimation::{Control, EstimationError};
use tautline_core::measurement::Dataset;

use crate::diagnosis::diagnose_dataset;
use crate::diagnosis::{Diagnosed, DiagnosisDocument, FindingDocument};
pub use document::{FormulasDocument, PatternDocument};
pub use grammar::{Formula, PATTERN, Reading, formulas};

/// Number of formulas of each part of a round that take part in the next round.
const KEPT: usize = 12;
/// Largest number of formulas that are listed.
const LISTED: usize = 8;

/// Formulas for the unexplained errors of a diagnosis.
#[derive(Debug)]
pub struct FoundFormulas {
    /// The diagnosis with the formulas.
    pub after: Diagnosed,
    /// The formulas that took part in it, by their identifiers.
    pub formulas: HashMap<String, Formula>,
}

/// Kinds of readings with an unmodelled error, as a finding or as an alternative of one.
#[must_use]
pub fn unexplained(diagnosed: &Diagnosed) -> Vec<Reading> {
    let mut found = Vec::new();
    for finding in &diagnosed.diagnosis.findings {
        let others = finding.alternatives.iter().map(|other| &other.subject);
        for subject in std::iter::once(&finding.subject).chain(others) {
            let reading = match subject {
                Subject::UnmodelledError(error) => Reading::of(error.readings.quantity),
                Subject::Cause(_) | Subject::WrongDrawing(_) | Subject::Slack(_) => None,
            };
            found.extend(reading.filter(|reading| !found.contains(reading)));
        }
    }
    found
}

/// Unmodelled errors, as findings or as alternatives, in sentences.
#[must_use]
pub fn unexplained_sentences(diagnosed: &Diagnosed) -> Vec<String> {
    let findings = diagnosed.diagnosis.findings.iter();
    let told = findings.filter_map(|finding| {
        let others = finding.alternatives.iter().map(|other| &other.subject);
        let mut subjects = std::iter::once(&finding.subject).chain(others);
        let unknown = subjects.find(|subject| subject.cause().is_none())?;
        Some(match finding.subject.cause() {
            None => finding.sentence.clone(),
            Some(_) => format!(
                "{}, unless it is: {}.",
                diagnosed.subject(unknown),
                diagnosed.subject(&finding.subject)
            ),
        })
    });
    told.collect()
}

/// Looks for formulas of the unexplained errors of a diagnosis, within its time limit for each round. `None` if nothing is
/// unexplained that formulas could describe.
///
/// # Errors
/// If the data cannot be used for an identification.
pub fn find_formulas(
    before: &Diagnosed,
    observe: &mut dyn FnMut(&DiagnosisProgress) -> Control,
) -> Result<Option<FoundFormulas>, EstimationError> {
    let readings = unexplained(before);
    let solution = &before.diagnosis.extended_solution;
    let all: Vec<Formula> = (readings.iter())
        .flat_map(|reading| formulas(*reading, &before.dataset, solution))
        .collect();
    if all.is_empty() {
        return Ok(None);
    }
    let room = MAX_HYPOTHESES
        .saturating_sub(before.dataset.robot.hypotheses.len())
        .max(1);
    let mut round = all;
    while round.len() > room {
        let mut best = Vec::new();
        for some in round.chunks(room) {
            let diagnosed = with(before, some, observe)?;
            best.extend(ranked(&diagnosed, some).into_iter().take(KEPT));
        }
        // Guarantees that each round has fewer formulas.
        if best.len() >= round.len() {
            best.truncate(room);
        }
        round = best;
    }
    let after = with(before, &round, observe)?;
    Ok(Some(FoundFormulas {
        after,
        formulas: round.into_iter().map(|one| (one.id.clone(), one)).collect(),
    }))
}

/// The diagnosis with formulas as hypotheses.
fn with(
    before: &Diagnosed,
    formulas: &[Formula],
    observe: &mut dyn FnMut(&DiagnosisProgress) -> Control,
) -> Result<Diagnosed, EstimationError> {
    let mut dataset = Dataset::clone(&before.dataset);
    for formula in formulas {
        if let Ok(hypothesis) = Hypothesis::parse(&formula.text) {
            // A hypothesis that the robot knows already, or has no room for, is left out.
            let _ = dataset.robot.add_hypothesis(&hypothesis);
        }
    }
    diagnose_dataset(Arc::new(dataset), (before.alpha, before.limit_s), observe)
}

/// Formulas in the order of their probability in a diagnosis, without those that are in no finding.
fn ranked(diagnosed: &Diagnosed, formulas: &[Formula]) -> Vec<Formula> {
    let document = diagnosed.document();
    let mut found: Vec<(f64, &Formula)> = Vec::new();
    for formula in formulas {
        let probability = causes(&document)
            .filter(|(effect, ..)| *effect == formula.id)
            .map(|(.., probability)| probability)
            .fold(0.0, f64::max);
        if probability > 0.0 {
            found.push((probability, formula));
        }
    }
    found.sort_by(|a, b| b.0.partial_cmp(&a.0).unwrap_or(Ordering::Equal));
    found
        .into_iter()
        .map(|(_, formula)| formula.clone())
        .collect()
}

/// Causes of all findings with their probabilities: effect, targets, probability.
fn causes(document: &DiagnosisDocument) -> impl Iterator<Item = (&str, &[String], f64)> {
    document.findings.iter().flat_map(of_finding)
}

fn of_finding(finding: &FindingDocument) -> impl Iterator<Item = (&str, &[String], f64)> {
    let own = (
        finding.subject.effect.as_str(),
        finding.subject.targets.as_slice(),
        finding.probability,
    );
    let others = finding.alternatives.iter();
    let others = others.map(|one| {
        (
            one.subject.effect.as_str(),
            one.subject.targets.as_slice(),
            one.probability,
        )
    });
    std::iter::once(own).chain(others)
}

impl FoundFormulas {
    /// The patterns of all findings, the likeliest of each first, with their probabilities given that one of them is true.
    #[must_use]
    pub fn patterns(&self) -> Vec<PatternDocument> {
        let document = self.after.document();
        let mut patterns = Vec::new();
        for finding in &document.findings {
            let own: Vec<_> = of_finding(finding)
                .filter_map(|(effect, targets, probability)| {
                    Some((self.formulas.get(effect)?, targets, probability))
                })
                .collect();
            let total: f64 = own.iter().map(|(.., probability)| probability).sum();
            for (formula, targets, probability) in own.into_iter().take(LISTED) {
                // Sizes and gain are those of the finding's first cause.
                let is_first =
                    finding.subject.effect == formula.id && finding.subject.targets == targets;
                patterns.push(PatternDocument {
                    expression: formula.expression.clone(),
                    effect: formula.id.clone(),
                    targets: targets.to_vec(),
                    probability: probability / total,
                    parameters: match is_first {
                        true => finding.parameters.clone(),
                        false => Vec::new(),
                    },
                    gain: is_first.then(|| finding.gain.clone()),
                    hypothesis: formula.text.clone(),
                });
            }
        }
        patterns
    }
}
