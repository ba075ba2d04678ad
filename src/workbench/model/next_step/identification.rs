//! The next step of phase 4: identify, diagnose, add what was found, until the model explains the readings.

use tautline_core::diagnosis::{Finding, Verdict};

use super::{Action, NextStep, identify};
use crate::model::command::{DIAGNOSING, IDENTIFYING, IdentificationCommand};
use crate::model::phase::{Phase, PhaseStatus};
use crate::model::{Model, OpenSession, findings, phase_status};
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::identification::FitVerdict;
use tautline_workflow::wording::count;

pub(super) fn of(model: &Model, open: &OpenSession) -> NextStep {
    let status = phase_status::of(model, open, Phase::Identification);
    if open.session().measurements.is_empty() {
        let action = Action::go(Phase::Measuring);
        return NextStep::new(status, Some(action), "Identification needs measured poses.");
    }
    for (title, text) in [
        (IDENTIFYING, "Identifying."),
        (DIAGNOSING, "Diagnosing the model."),
    ] {
        let running = model
            .tasks
            .running()
            .iter()
            .find(|task| task.title == title);
        if let Some(task) = running {
            let progress = task.progress();
            let words = match progress.text.is_empty() {
                true => text.to_owned(),
                false => format!("{}: {}.", text.trim_end_matches('.'), progress.text),
            };
            return NextStep::wait(words, progress.fraction, "");
        }
    }
    let Some(fit) = open.fit().filter(|_| open.fit_is_current()) else {
        let then = "Then: check whether the model explains the readings.";
        return NextStep::new(status, Some(identify()), then);
    };
    let poses = count(fit.dataset.measurements.len(), "pose");
    let status = PhaseStatus {
        line: format!("identified from {poses}: {}", status.line),
        ..status
    };
    let diagnosed = open.diagnosis().filter(|_| open.diagnosis_is_current());
    if let Some(diagnosed) = diagnosed
        && let Some(step) = proposed(open, diagnosed, status.clone())
    {
        return step;
    }
    let is_adequate = match FitVerdict::of(fit.solution.p_value()) {
        FitVerdict::Inadequate | FitVerdict::Doubtful => false,
        FitVerdict::Adequate | FitVerdict::NoiseOverstated | FitVerdict::Untested => true,
    };
    if !is_adequate && !open.is_model_diagnosed() {
        let action = Action::new("Diagnose model", IdentificationCommand::Diagnose);
        return NextStep::new(status, Some(action), "Then: add the causes to the model.");
    }
    let then = match is_adequate {
        true => "Then: measure the accuracy, write the values, measure again.",
        false => {
            "The model does not explain the data: values from it can make the robot less accurate."
        }
    };
    NextStep::new(status, Some(Action::go(Phase::Adjustment)), then)
}

/// What a diagnosis proposes that is not decided yet: causes for the model first, then poses that tell causes apart.
fn proposed(open: &OpenSession, diagnosed: &Diagnosed, status: PhaseStatus) -> Option<NextStep> {
    let undecided = findings::undecided(open, diagnosed);
    let is_list = |finding: &&Finding| finding.is_list();
    let has_name = |finding: &&Finding| finding.verdict() != Verdict::Unknown && !finding.is_list();
    let named: Vec<&Finding> = undecided.iter().copied().filter(has_name).collect();
    let then = "Then: the model is identified again.";
    if let [first, others @ ..] = &named[..] {
        let title = match others {
            [] => format!("Add to model: {}", diagnosed.subject(&first.subject)),
            _ => "Add all findings".to_owned(),
        };
        let action = Action::new(title, findings::adding(diagnosed, &named));
        return Some(NextStep::new(status, Some(action), then));
    }
    let finding = undecided.into_iter().find(is_list)?;
    let poses = finding.separation.as_ref().map_or(&[][..], |s| &s.poses);
    if poses.is_empty() {
        let likeliest = diagnosed.subject(&finding.subject);
        let action = Action::new(
            format!("Add to model: {likeliest}"),
            findings::adding(diagnosed, &[finding]),
        );
        let then = "It is the likeliest of several causes, which are compared above.";
        return Some(NextStep::new(status, Some(action), then));
    }
    if findings::are_planned(open, poses) {
        let action = Action::go(Phase::Measuring);
        let then = "Several causes are possible: the poses that tell them apart are planned.";
        return Some(NextStep::new(status, Some(action), then));
    }
    let action = Action::new(
        format!("Add {} to the plan", count(poses.len(), "pose")),
        findings::planning(open, poses),
    );
    let then =
        "Several causes are possible: measure the poses that tell them apart, or choose one above.";
    Some(NextStep::new(status, Some(action), then))
}
