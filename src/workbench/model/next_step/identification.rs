//! The next step of phase 4: identify, diagnose, add what was found, until the model explains the readings.

use tautline_core::diagnosis::{Finding, Verdict};
use tautline_core::effect::EffectSetting;

use super::{Action, NextStep, identify};
use crate::model::command::{DIAGNOSING, IDENTIFYING, IdentificationCommand};
use crate::model::edit::{Edit, same_effect};
use crate::model::phase::{Phase, PhaseStatus};
use crate::model::{Model, OpenSession, phase_status};
use tautline_workflow::documents::diagnosis::Diagnosed;
use tautline_workflow::identification::FitVerdict;
use tautline_workflow::wording::{count, sentence};

pub(super) fn of(model: &Model, open: &OpenSession) -> NextStep {
    let status = phase_status::of(open, Phase::Identification);
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
    let explains = FitVerdict::of(fit.solution.p_value());
    if let Some(diagnosed) = diagnosed
        && let Some(step) = proposed(open, diagnosed, status.clone())
    {
        return step;
    }
    match explains {
        FitVerdict::Inadequate | FitVerdict::Doubtful if diagnosed.is_none() => {
            let action = Action::new("Diagnose model", IdentificationCommand::Diagnose);
            NextStep::new(status, Some(action), "Then: add the cause to the model.")
        }
        FitVerdict::Inadequate => {
            let action = Action::go(Phase::Adjustment);
            let then = "The model does not explain the data: values from it can make the robot less accurate.";
            NextStep::new(status, Some(action), then)
        }
        _ => {
            let action = Action::go(Phase::Adjustment);
            let then = "Then: measure the accuracy, write the values, measure again.";
            NextStep::new(status, Some(action), then)
        }
    }
}

/// What a diagnosis proposes that is not in the model yet.
fn proposed(open: &OpenSession, diagnosed: &Diagnosed, status: PhaseStatus) -> Option<NextStep> {
    let findings = &diagnosed.diagnosis.findings;
    let is_new = |finding: &&Finding| {
        let added = &open.session().settings.identification.effects;
        let is_added = |one: &EffectSetting| added.iter().any(|other| same_effect(one, other));
        !settings(diagnosed, finding).iter().all(is_added)
    };
    let finding = findings.iter().find(is_new)?;
    Some(match finding.verdict {
        Verdict::Named => {
            let name = diagnosed.title(&finding.cause);
            let what = format!("add {name} to the model");
            let edit = Edit::AddEffects(settings(diagnosed, finding), what);
            let action = Action::new(format!("Add to model: {name}"), edit);
            let then = "Then: the model is identified again.";
            NextStep::new(status, Some(action), then)
        }
        Verdict::Ambiguous => {
            let then = "Several causes are possible: measure the poses that tell them apart, or choose one above.";
            NextStep::new(status, None, then)
        }
        Verdict::Unknown => {
            let then = format!(
                "{} Choose above whether the model gets a curve for it.",
                sentence(&finding.sentence)
            );
            NextStep::new(status, None, then)
        }
    })
}

/// The effects of a finding as the model takes them.
fn settings(diagnosed: &Diagnosed, finding: &Finding) -> Vec<EffectSetting> {
    let instances = finding.cause.instances.iter();
    let settings = instances.map(|bound| bound.setting(diagnosed.robot()));
    settings.collect()
}
