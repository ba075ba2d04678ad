//! Simulates cases, diagnoses them and compares the findings with the truth.

use anyhow::Result;
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{
    Cause, Diagnosis, Finding, NoiseStatement, PossibleCause, Subject, Verdict,
};
use tautline_core::effect::{BoundEffect, EffectSetting};
use tautline_core::estimation::{Geometry, Problem};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_core::simulation::Simulated;

use super::draw::{Drawn, draw};
use super::exchange::{is_exchange, is_undone};
use super::judge::{self, Claim, Found, judge, matched, wrong_names};
use super::measure::{ParameterError, held_out_ratio, parameter_errors, rivals_fit};
use super::robots::Truth;
use super::{Circumstances, Conditions, Hidden, Plan, Setup, Wanted};
use crate::tables::simulated::{diagnosed, solved};
use crate::tables::study::{Records, results};

/// A cause of a finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// Identifier with cable numbers.
    pub name: String,
    /// Stated probability.
    pub probability: f64,
    /// Whether the cause is hidden.
    pub right: bool,
}

/// One finding of a diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FindingRecord {
    /// Identifiers with cable numbers.
    pub text: String,
    /// How certain the finding is.
    pub verdict: Verdict,
    /// Reduction of chi-square.
    pub gain: f64,
    /// The cause and its alternatives; empty for an unknown error.
    pub candidates: Vec<Candidate>,
}

/// Result for the same dataset without empty cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WithoutHoles {
    /// Result for each hidden effect of the catalogue.
    pub found: Vec<Found>,
    /// Whether a fit of the true model to the data with empty cells reaches the same solution from the usual start as
    /// from the truth.
    pub fit_arrives: bool,
}

/// Outcome of the diagnosis of one dataset.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    /// The plan of the dataset.
    pub plan: Plan,
    /// The case that was drawn.
    pub drawn: Drawn,
    /// Result for each hidden effect of the catalogue, or for the exchange of channels.
    pub found: Vec<Found>,
    /// The findings.
    pub said: Vec<FindingRecord>,
    /// Possible causes that are not findings.
    pub possible: Vec<Candidate>,
    /// Readings whose noise is reported to differ from the description: kind and cable, and ratio.
    pub noise: Vec<(String, f64)>,
    /// Effects that are named although they are not hidden.
    pub wrong_names: Vec<String>,
    /// Parameter errors of correctly named effects.
    pub parameters: Vec<ParameterError>,
    /// Held-out error relative to that of the true model.
    pub held_out_ratio: Option<f64>,
    /// Result without empty cells, for datasets that have any.
    pub without_holes: Option<WithoutHoles>,
    /// Processor time of the diagnosis (s).
    pub seconds: f64,
}

impl Outcome {
    /// The findings without their probabilities.
    #[must_use]
    pub fn answer(&self) -> String {
        let mut said: Vec<&str> = self.said.iter().map(|said| said.text.as_str()).collect();
        said.sort_unstable();
        said.join("; ")
    }

    /// Whether an unknown error is reported although none is hidden.
    #[must_use]
    pub fn unknown_without_reason(&self) -> bool {
        let nothing_unknown = self.plan.circumstances != Circumstances::ModelError
            && !matches!(self.plan.wanted, Wanted::Outside(_));
        nothing_unknown
            && self
                .said
                .iter()
                .any(|said| said.verdict == Verdict::Unknown)
    }
}

/// Outcomes of many plans.
#[derive(Debug, Clone, Default)]
pub struct Study {
    /// Outcomes, in the order of the plans.
    pub outcomes: Vec<Outcome>,
    /// Number of plans for whose effect the robot has no reading.
    pub not_applicable: usize,
    /// Plans that failed, with the reason.
    pub impossible: Vec<(Plan, String)>,
}

/// Simulates and diagnoses a case.
///
/// # Errors
/// If the case cannot be simulated or diagnosed.
pub fn run(plan: &Plan, drawn: Drawn) -> Result<Outcome> {
    let Drawn {
        hidden, conditions, ..
    } = &drawn;
    let setup = Setup::new(plan, *conditions)?;
    let mut run = setup.measured(hidden)?;
    let mut without_holes = None;
    if conditions.holes {
        let (_, claims, _) = run_diagnosis(&run.dataset)?;
        let found = judge_claims(&run, (hidden, conditions), &claims)?;
        setup.lose_cells(&mut run);
        without_holes = Some(WithoutHoles {
            found: found.iter().map(|(found, _)| *found).collect(),
            fit_arrives: fit_arrives(&run, hidden.effects())?,
        });
    }
    let (diagnosis, claims, seconds) = run_diagnosis(&run.dataset)?;
    let found = judge_claims(&run, (hidden, conditions), &claims)?;
    let truths = hidden.effects();
    let robot = &run.dataset.robot;
    let mut wrong = wrong_names(truths, &claims, robot);
    let undone = matches!(hidden, Hidden::Exchanged(..)) && found[0].0 == Found::Named;
    if undone {
        let first = |claim: &&Claim| claim.candidates[0].cause().is_some_and(is_exchange);
        let exchanges = claims.iter().filter(first);
        let right: Vec<String> = exchanges.map(Claim::describe).collect();
        wrong.retain(|name| !right.contains(name));
    }
    let comparable = *conditions == Conditions::default() && setup.robot.truth == Truth::AsStated;
    let held_out_ratio = if truths.is_empty() || !comparable {
        None
    } else {
        let extended = diagnosis.extended_solution.globals.model(robot);
        held_out_ratio(&setup, &run, extended)?
    };
    let possible = |other: &PossibleCause| Candidate {
        name: judge::describe(&Subject::Cause(other.cause.clone())),
        probability: other.probability,
        right: !matched(truths, &other.cause, robot).is_empty(),
    };
    let record =
        |claim: &Claim| finding_record(claim, &diagnosis.findings, (truths, undone), robot);
    Ok(Outcome {
        plan: *plan,
        found: found.iter().map(|(found, _)| *found).collect(),
        said: claims.iter().map(record).collect(),
        possible: diagnosis.possible.iter().map(possible).collect(),
        noise: diagnosis.noise.iter().map(noise).collect(),
        wrong_names: wrong,
        parameters: errors(&diagnosis, &found, (&claims, truths), &run),
        held_out_ratio,
        without_holes,
        seconds,
        drawn,
    })
}

/// Diagnoses a dataset. Returns the diagnosis, its claims and the processor time (s).
fn run_diagnosis(dataset: &Dataset) -> Result<(Diagnosis, Vec<Claim>, f64)> {
    let (diagnosis, seconds) = diagnosed(dataset)?;
    let claims = Claim::of(&diagnosis.findings);
    Ok((diagnosis, claims, seconds))
}

fn noise(statement: &NoiseStatement) -> (String, f64) {
    let cable = statement.cable.map(|cable| format!(":{}", cable + 1));
    let name = statement.quantity.name();
    (
        format!("{name}{}", cable.unwrap_or_default()),
        statement.ratio,
    )
}

fn finding_record(
    claim: &Claim,
    findings: &[Finding],
    (truths, undone): (&[EffectSetting], bool),
    robot: &Robot,
) -> FindingRecord {
    let is_right =
        |cause: &Cause| !matched(truths, cause, robot).is_empty() || undone && is_exchange(cause);
    let candidate = |(subject, probability): (&Subject, &f64)| {
        Some(Candidate {
            name: judge::describe(subject),
            probability: *probability,
            right: is_right(subject.cause()?),
        })
    };
    let pairs = claim.candidates.iter().zip(&claim.probabilities);
    FindingRecord {
        text: claim.describe(),
        verdict: claim.verdict,
        gain: findings[claim.finding].evidence.delta_chi2,
        candidates: pairs.filter_map(candidate).collect(),
    }
}

/// Whether a fit with the hidden effects free reaches the same solution from its usual start as from the truth.
fn fit_arrives(run: &Simulated, effects: &[EffectSetting]) -> Result<bool> {
    let bound = |at_truth: bool| -> Result<Vec<BoundEffect>> {
        let mut all = Vec::new();
        for effect in effects {
            let mut bound = BoundEffect::from_setting(effect, &run.dataset.robot)?;
            for (value, parameter) in bound.values.iter_mut().zip(bound.effect.parameters()) {
                if !at_truth && !parameter.discrete {
                    *value = parameter.start;
                }
            }
            all.push(bound);
        }
        Ok(all)
    };
    let chi2 = |at_truth: bool| -> Result<f64> {
        let mut problem = Problem::new(&run.dataset)?;
        problem.geometry = Geometry::Estimated;
        problem.free_effects = bound(at_truth)?;
        Ok(solved(&problem)?.chi2)
    };
    // Phase and period of a wave are found by a search before the fit, so the usual start says nothing about them.
    let is_wave = |effect: &EffectSetting| effect.parameters.contains_key("phase");
    if effects.iter().any(is_wave) {
        return Ok(true);
    }
    Ok(chi2(false)? < chi2(true)? + 1.0)
}

/// Compares claims with the truth, checking lists by fits of their members.
fn judge_claims(
    run: &Simulated,
    (hidden, conditions): (&Hidden, &Conditions),
    claims: &[Claim],
) -> Result<Vec<(Found, Option<usize>)>> {
    let robot = &run.dataset.robot;
    if let Hidden::Exchanged(channels, cables) = hidden {
        let named = is_undone((*channels, *cables), claims, robot);
        let unknown = claims.iter().any(|claim| claim.verdict == Verdict::Unknown);
        let found = match (named, claims.is_empty(), unknown) {
            (true, ..) => Found::Named,
            (_, true, _) => Found::Missed,
            (.., true) => Found::Unknown,
            _ => Found::OtherNamed,
        };
        return Ok(vec![(found, None)]);
    }
    let truths = hidden.effects();
    let actual = Dataset {
        robot: conditions.noise.of(robot),
        measurements: run.dataset.measurements.clone(),
    };
    let mut found = judge(truths, claims, robot);
    for (truth, (found, claim)) in found.iter_mut().enumerate() {
        if let (Found::Listed, Some(claim)) = (*found, *claim)
            && !rivals_fit(&actual, &claims[claim].candidates, truths, truth)?
        {
            *found = Found::ListedNeedlessly;
        }
    }
    Ok(found)
}

/// Parameter errors of correctly named effects, once per finding.
fn errors(
    diagnosis: &Diagnosis,
    found: &[(Found, Option<usize>)],
    (claims, truths): (&[Claim], &[EffectSetting]),
    run: &Simulated,
) -> Vec<ParameterError> {
    let named = found.iter().filter(|(found, _)| *found == Found::Named);
    let mut findings: Vec<usize> = named
        .filter_map(|(_, claim)| Some(claims[(*claim)?].finding))
        .collect();
    findings.sort_unstable();
    findings.dedup();
    let errors =
        |finding: usize| parameter_errors(&diagnosis.findings[finding], truths, &run.dataset.robot);
    findings.into_iter().flat_map(errors).collect()
}

/// Draws and runs all plans. Recorded outcomes are reused, and new ones are recorded.
#[must_use]
pub fn run_all(plans: &[Plan], records: &Records<Plan, Outcome>) -> Study {
    let outcome = |plan: &Plan| draw(plan)?.map(|drawn| run(plan, drawn)).transpose();
    let mut study = Study::default();
    for (plan, result) in results(plans.to_vec(), records, outcome) {
        match result {
            Ok(Some(outcome)) => study.outcomes.push(outcome),
            Ok(None) => study.not_applicable += 1,
            Err(error) => study.impossible.push((plan, format!("{error:#}"))),
        }
    }
    study
}
