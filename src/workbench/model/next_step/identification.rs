//! Next step of phase 4: identify, diagnose, add causes, until the model explains the readings.

use tautline_core::diagnosis::{Cause, Finding, Verdict};
use tautline_core::effect::EffectSetting;
use tautline_core::planning::USUAL_POSES;

use super::{NextStep, Problem, Remedy, identify, plan, status};
use crate::model::command::{FileCommand, IdentificationCommand, ImportCommand, RecordingCommand};
use crate::model::phase::Phase;
use crate::model::{Model, OpenSession, findings};
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::foreign_writes;
use tautline_workflow::identification::{FitVerdict, Identification};
use tautline_workflow::importing::can_import_again;
use tautline_workflow::precalibration::Table;
use tautline_workflow::readiness::{COMPLETE, CheckItem, CheckOutcome, PLAUSIBLE};
use tautline_workflow::wording::{count, sentence};

pub(super) fn of(model: &Model, open: &OpenSession) -> NextStep {
    let status = status(model, open, Phase::Identification);
    if open.session().measurements.is_empty() {
        let go = Remedy::go(Phase::Measuring, "Identification needs measured poses.");
        return NextStep::new(status, go);
    }
    let Some(fit) = open.current_fit() else {
        let then = "Then: check whether the model explains the readings.";
        return NextStep::new(status, identify(then));
    };
    let is_doubtful = FitVerdict::of(fit.solution.p_value()) == FitVerdict::Doubtful;
    if is_doubtful && !open.is_model_diagnosed() {
        return NextStep::new(status, diagnose());
    }
    let then = match is_doubtful {
        false => "Then: measure the accuracy, write the values, measure again.",
        true => {
            "The model hardly explains the data: values from it can make the robot less accurate."
        }
    };
    NextStep::new(status, Remedy::go(Phase::Adjustment, then))
}

/// Problems of the readings and the model, and undecided findings of the diagnosis.
pub(super) fn problems(model: &Model, open: &OpenSession) -> Vec<Problem> {
    let mut problems = of_values(model, open);
    let diagnosed = open.diagnosis().filter(|_| open.diagnosis_is_current());
    if let Some(diagnosed) = diagnosed {
        let undecided = findings::undecided(open, diagnosed);
        let step = of_findings(model, diagnosed, &undecided);
        let text = format!("{} to look at.", count(undecided.len(), "finding"));
        problems.extend(step.map(|remedy| Problem::new(text, remedy)));
    }
    problems
}

/// Problems of readings and fit that rule out using the values.
pub(super) fn of_values(model: &Model, open: &OpenSession) -> Vec<Problem> {
    if open.session().measurements.is_empty() {
        return Vec::new();
    }
    let checks = checked(model, open);
    let mut problems: Vec<Problem> = checks
        .into_iter()
        .filter_map(|(_, problem)| problem)
        .collect();
    let written = foreign_writes::sentences(open.session()).into_iter();
    problems.extend(written.map(|text| Problem::new(text, measure_again(Vec::new()))));
    if let Some(fit) = open.current_fit() {
        problems.extend(of_fit(model, open, fit));
    }
    problems
}

/// Checks of the readings, each with its problem unless the model explains the readings.
#[must_use]
pub fn checked<'m>(
    model: &'m Model,
    open: &'m OpenSession,
) -> Vec<(&'m CheckItem, Option<Problem>)> {
    let whole = model.identification.readiness.as_ref();
    let whole = whole.filter(|(of, _)| *of == open.inputs());
    let items = whole.map_or(open.checked_readings(), |(_, found)| &found.checks);
    let fit = open.current_fit();
    let is_explained =
        fit.is_some_and(|fit| FitVerdict::of(fit.solution.p_value()) == FitVerdict::Adequate);
    let problem = |item: &CheckItem| {
        (item.outcome == CheckOutcome::Fail && !is_explained).then(|| {
            let mut remedy = of_check(model, open, item);
            remedy.then = item.action.clone().unwrap_or(remedy.then);
            let text = format!("{}: {}", item.title(), item.sentence);
            Problem::new(text, remedy)
        })
    };
    items.iter().map(|item| (item, problem(item))).collect()
}

/// Remedy of a failed check: a wrong sign, unit or channel is corrected in the recipe, if any, otherwise by the doctor.
fn of_check(model: &Model, open: &OpenSession, item: &CheckItem) -> Remedy {
    match item.name.as_str() {
        COMPLETE | PLAUSIBLE if can_import_again(open.session()) => {
            let then = "Then: import the readings again.";
            Remedy::new("Back to import", RecordingCommand::Correct, then)
        }
        PLAUSIBLE => of_model(model, open),
        COMPLETE if !open.missing().is_empty() => {
            Remedy::go(Phase::Measuring, "Then: measure the poses.")
        }
        _ => more_poses(),
    }
}

/// Problems of a fit.
#[must_use]
pub fn of_fit(model: &Model, open: &OpenSession, fit: &Identification) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut add = |text: String, remedy: Remedy| problems.push(Problem::new(text, remedy));
    if !fit.solution.converged() {
        let text = "The identification did not converge: do not use these values.";
        add(text.to_owned(), of_model(model, open));
    }
    if let Some(place) = fit.extrapolation() {
        let text = format!("{}: the result does not hold there.", sentence(&place));
        let show = ImportCommand::Show(Table::Elongation);
        let then = "Then: identify the pulleys again.";
        add(
            text,
            Remedy::new("Measure the elongation further", show, then),
        );
    }
    let explains = FitVerdict::of(fit.solution.p_value());
    let diagnosed = open.diagnosis().filter(|_| open.is_model_diagnosed());
    if explains == FitVerdict::Inadequate || diagnosed.is_some_and(|d| !findings::explain(d)) {
        let text = format!("{}.", sentence(FitVerdict::Inadequate.words()));
        add(text, of_model(model, open));
    }
    problems
}

/// Remedy of a model that does not explain the readings.
fn of_model(model: &Model, open: &OpenSession) -> Remedy {
    let diagnosed = open.diagnosis().filter(|_| open.diagnosis_is_current());
    let Some(diagnosed) = diagnosed else {
        return diagnose();
    };
    if !diagnosed.mistakes.is_empty() {
        let then = "Then: identify the pulleys. The present readings stay in their file.";
        return Remedy::new(
            "Correct a copy of the session",
            FileCommand::OpenCorrected,
            then,
        );
    }
    let undecided = findings::undecided(open, diagnosed);
    let of_findings = of_findings(model, diagnosed, &undecided);
    of_findings.unwrap_or_else(|| match open.is_model_diagnosed() {
        false => diagnose(),
        true if diagnosed.diagnosis.noise.is_empty() => more_poses(),
        true => Remedy::go(
            Phase::Modeling,
            "No cause was found, but the noise is not the stated one: correct it in the description.",
        ),
    })
}

/// Next step for findings: permanent causes and single wrong readings are added to the model, others are repaired and measured again;
/// then poses separate several causes, and patterns describe errors without a cause.
fn of_findings(model: &Model, diagnosed: &Diagnosed, undecided: &[&Finding]) -> Option<Remedy> {
    let open = model.open.as_ref()?;
    let has_name = |finding: &&Finding| finding.verdict() != Verdict::Unknown && !finding.is_list();
    let named: Vec<&Finding> = undecided.iter().copied().filter(has_name).collect();
    let not_added = model.identification.not_added.as_ref();
    let lasts = |finding: &Finding| {
        let effect = finding.cause().map(Cause::effect);
        let is_repaired =
            effect.is_some_and(|effect| effect.is_damage() && !effect.is_wrong_reading());
        let failed =
            not_added.is_some_and(|(effects, _)| findings::has_any(diagnosed, finding, effects));
        !is_repaired && !failed
    };
    let (lasting, passing): (Vec<&Finding>, Vec<&Finding>) =
        named.iter().copied().partition(|finding| lasts(finding));
    if let [first, others @ ..] = &lasting[..] {
        let title = match others.len() {
            0 => format!("Add to model: {}", diagnosed.subject(&first.subject)),
            _ if lasting.len() == undecided.len() => "Add all findings".to_owned(),
            _ => format!("Add {}", count(lasting.len(), "finding")),
        };
        let add = findings::adding(diagnosed, &lasting);
        return Some(Remedy::new(
            title,
            add,
            "Then: the model is identified again.",
        ));
    }
    if !passing.is_empty() {
        let causes = passing.iter().filter_map(|finding| finding.cause());
        let repaired = causes.flat_map(|cause| diagnosed.settings(cause));
        return Some(measure_again(repaired.collect()));
    }
    let Some(finding) = undecided.iter().find(|finding| finding.is_list()) else {
        return (!undecided.is_empty()).then(|| pattern(model, open));
    };
    let poses = finding.separation.as_ref().map_or(&[][..], |s| &s.poses);
    let likeliest = diagnosed.subject(&finding.subject);
    Some(if poses.is_empty() {
        let title = format!("Add to model: {likeliest}");
        let then = "It is the likeliest of several causes, which are compared above.";
        Remedy::new(title, findings::adding(diagnosed, &[finding]), then)
    } else if findings::are_planned(open, poses) {
        let then = "Several causes are possible: the poses that tell them apart are planned.";
        Remedy::go(Phase::Measuring, then)
    } else {
        let title = format!("Add {} to the plan", count(poses.len(), "pose"));
        let then = "Several causes are possible: measure the poses that tell them apart, or choose one above.";
        Remedy::new(title, findings::planning(open, poses), then)
    })
}

/// Next step for an error without a known cause: look for patterns, then add the likeliest one to the model.
fn pattern(model: &Model, open: &OpenSession) -> Remedy {
    let found = model.identification.patterns.as_ref();
    match found.filter(|(of, _)| *of == open.inputs()) {
        None => Remedy::new(
            "What does it look like?",
            IdentificationCommand::FindFormulas,
            "No known cause explains the error: formulas of position, tension and time are tried.",
        ),
        Some((_, Ok(patterns))) if !patterns.is_empty() => Remedy::new(
            "Extend the model by the likeliest pattern",
            findings::extending(&patterns[0]),
            "A pattern is no cause. Then: the model is identified again.",
        ),
        Some(_) => Remedy {
            then: "No known cause and no pattern explains the error: look for it in the workshop first.".to_owned(),
            ..measure_again(Vec::new())
        },
    }
}

fn diagnose() -> Remedy {
    let then = "Then: add the causes to the model.";
    Remedy::new("Diagnose model", IdentificationCommand::Diagnose, then)
}

/// New series of the same poses, without the repaired effects.
fn measure_again(repaired: Vec<EffectSetting>) -> Remedy {
    let title = match repaired.len() {
        0 => "Measure again",
        _ => "Repaired: measure again",
    };
    let then = "The same poses in a new series. The present readings stay in their file.";
    Remedy::new(title, FileCommand::NewSeries(repaired), then)
}

fn more_poses() -> Remedy {
    plan(USUAL_POSES, "No cause was found: more poses show more.").in_phase(Phase::Measuring)
}
