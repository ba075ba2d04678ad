//! Simulates cases, asks the doctor and judges what it says.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use anyhow::{Context, Result};
use tautline_core::diagnosis::{Diagnosis, DiagnosisOptions, Verdict, diagnose};
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::Control;
use tautline_core::simulation::Simulated;

use super::draw::{Drawn, draw};
use super::judge::{Claim, Found, judge, wrong_names};
use super::measure::{ParameterError, held_out_ratio, parameter_errors, rivals_fit};
use super::outside::Scene;
use super::robots::robot;
use super::visibility::simulated;
use super::{Case, Hidden, Plan};

/// What the doctor made of one data set.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was asked for.
    pub plan: Plan,
    /// What was hidden.
    pub drawn: Drawn,
    /// What became of each hidden effect of the catalogue.
    pub found: Vec<Found>,
    /// What was said, finding by finding.
    pub answers: Vec<String>,
    /// Verdict of each finding.
    pub verdicts: Vec<Verdict>,
    /// Chi-square gained by each finding.
    pub delta_chi2: Vec<f64>,
    /// Effects named with confidence that were not hidden.
    pub wrong_names: Vec<String>,
    /// Errors of the parameters of effects that were named rightly.
    pub parameters: Vec<ParameterError>,
    /// Held-out error over that of the true model.
    pub held_out_ratio: Option<f64>,
    /// Time of the diagnosis (s).
    pub seconds: f64,
}

/// Outcomes of many plans.
#[derive(Debug, Clone, Default)]
pub struct Study {
    /// Outcomes, in the order of the plans.
    pub outcomes: Vec<Outcome>,
    /// Plans for whose effect the robot has no reading.
    pub not_applicable: usize,
    /// Plans of which nothing could be made, and why.
    pub impossible: Vec<(Plan, String)>,
}

/// Simulates a case and asks the doctor.
///
/// # Errors
/// If the case cannot be simulated or diagnosed.
pub fn run(plan: &Plan, drawn: Drawn) -> Result<Outcome> {
    let case = &drawn.case;
    let robot = robot(case.robot).with_context(|| format!("no robot {}", case.robot))?;
    let (run, truths) = measured(case)?;
    let started = Instant::now();
    let diagnosis = diagnose(&run.dataset, &DiagnosisOptions::default(), &mut |_| {
        Control::Continue
    })?;
    let seconds = started.elapsed().as_secs_f64();
    let claims = Claim::of(&diagnosis.findings);
    let found = judged(&run, &truths, &claims)?;
    let held_out_ratio = if truths.is_empty() {
        None
    } else {
        let globals = &diagnosis.extended_solution.globals;
        held_out_ratio(&robot, case.seed, &run, globals)?
    };
    Ok(Outcome {
        plan: *plan,
        found: found.iter().map(|(found, _)| *found).collect(),
        answers: claims.iter().map(Claim::describe).collect(),
        verdicts: claims.iter().map(|claim| claim.verdict).collect(),
        delta_chi2: claims
            .iter()
            .map(|claim| diagnosis.findings[claim.finding].evidence.delta_chi2)
            .collect(),
        wrong_names: wrong_names(&truths, &claims, &run.dataset.robot),
        parameters: errors(&diagnosis, &found, (&claims, &truths), &run),
        held_out_ratio,
        seconds,
        drawn,
    })
}

/// The data of a case, with noise, and the effects of the catalogue hidden in them.
fn measured(case: &Case) -> Result<(Simulated, Vec<EffectSetting>)> {
    let robot = robot(case.robot).with_context(|| format!("no robot {}", case.robot))?;
    let settings = match &case.hidden {
        Hidden::Effects(settings) => settings.clone(),
        Hidden::Nothing | Hidden::Outside(..) => Vec::new(),
    };
    let mut run = simulated(&robot, case.seed, &settings, true)?;
    if let Hidden::Outside(effect, size) = case.hidden {
        let scene = Scene::new(&run.truth, case.seed);
        (effect.change)(&scene, size, &mut run.dataset.measurements);
    }
    Ok((run, settings))
}

/// The judgement, lists checked by fits of their members.
fn judged(
    run: &Simulated,
    truths: &[EffectSetting],
    claims: &[Claim],
) -> Result<Vec<(Found, Option<usize>)>> {
    let mut found = judge(truths, claims, &run.dataset.robot);
    for (truth, (found, claim)) in found.iter_mut().enumerate() {
        if let (Found::Listed, Some(claim)) = (*found, *claim)
            && !rivals_fit(&run.dataset, &claims[claim].candidates, truths, truth)?
        {
            *found = Found::ListedNeedlessly;
        }
    }
    Ok(found)
}

/// Parameter errors of what is named rightly, each finding once.
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

/// What became of the plans, in their order. `None`: the robot has no reading for the effect.
type Results<T> = Vec<(Plan, Result<Option<T>>)>;

/// Does a job for all plans, as many at a time as the machine has processors.
fn in_parallel<T: Send>(
    plans: &[Plan],
    job: impl Fn(&Plan) -> Result<Option<T>> + Sync,
) -> Results<T> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    let work = || {
        loop {
            let n = next.fetch_add(1, Ordering::Relaxed);
            let Some(plan) = plans.get(n) else {
                break;
            };
            let result = job(plan);
            if let Ok(mut results) = results.lock() {
                results.push((n, *plan, result));
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let mut results = results.into_inner().unwrap_or_default();
    results.sort_by_key(|(n, ..)| *n);
    let numbered = results.into_iter();
    numbered.map(|(_, plan, result)| (plan, result)).collect()
}

/// Draws and runs all plans.
#[must_use]
pub fn run_all(plans: &[Plan]) -> Study {
    let job = |plan: &Plan| draw(plan)?.map(|drawn| run(plan, drawn)).transpose();
    let mut study = Study::default();
    for (plan, result) in in_parallel(plans, job) {
        match result {
            Ok(Some(outcome)) => study.outcomes.push(outcome),
            Ok(None) => study.not_applicable += 1,
            Err(error) => study.impossible.push((plan, format!("{error:#}"))),
        }
    }
    study
}

/// Draws all plans without asking the doctor.
#[must_use]
pub fn draw_all(plans: &[Plan]) -> Results<Drawn> {
    in_parallel(plans, draw)
}
