//! The next step of phase 5, along its checklist.

use tautline_session::Stage;

use super::{Action, CheckState, Item, NextStep, checklist, connecting, waits};
use crate::model::command::{ReportCommand, RobotCommand};
use crate::model::phase::{Phase, PhaseStatus, Progress};
use crate::model::{Model, OpenSession, phase_status};
use tautline_workflow::controllers::Kind;
use tautline_workflow::report::ReportFormat;
use tautline_workflow::wording::count;

pub(super) fn of(model: &Model, open: &OpenSession) -> NextStep {
    if let Some(waits) = waits(model) {
        return waits;
    }
    let status = phase_status::of(model, open, Phase::Adjustment);
    if !open.fit_is_current() {
        let action = match open.session().measurements.is_empty() {
            true => Action::go(Phase::Measuring),
            false => super::identify(),
        };
        let then = match open.fit() {
            Some(_) => "The data changed after the last identification.",
            None => "There is nothing to write before the pulleys are identified.",
        };
        return NextStep::new(status, Some(action), then);
    }
    let review = model.review();
    let changes = review.changes().count();
    let checks = checklist(open, &review.lines);
    let next = checks.iter().find(|check| check.state == CheckState::Next);
    let Some(next) = next.map(|check| check.item) else {
        let action = Action::new(
            match ReportFormat::FOR_PAPER {
                ReportFormat::Html => "Save report as HTML…",
                ReportFormat::Pdf => "Save report as PDF…",
            },
            ReportCommand::AskSave(ReportFormat::FOR_PAPER),
        );
        let status = PhaseStatus::new(
            Progress::Done,
            "the robot is adjusted, verified and accepted",
        );
        return NextStep::new(status, Some(action), "Then: save the session.");
    };
    let is_worse = checks.iter().any(|check| check.state == CheckState::Bad);
    if next == Item::Accept && !is_worse {
        let accept = Action::new("Accept the robot", RobotCommand::Accept);
        return NextStep::new(status, Some(accept), "Then: save the report.");
    }
    if let Some((action, then)) = connecting(model, open.session()) {
        return NextStep::new(status, action, then);
    }
    let (action, then) = match next {
        Item::MeasureBefore => missing_parameters(model, &review.lines)
            .map(|action| {
                (
                    action,
                    "The controller gets parameters for what the doctor found.",
                )
            })
            .unwrap_or_else(|| measure(Stage::Before)),
        Item::Review | Item::Write if changes > 0 => {
            let title = format!("Write {}…", count(changes, "value"));
            let then = "You are asked for your name before anything is written.";
            (Action::new(title, RobotCommand::Write), then)
        }
        Item::Review | Item::Write | Item::MeasureAfter => measure(Stage::After),
        Item::Accept => {
            let back = Action::new("Roll back the values", RobotCommand::RollBack);
            (
                back,
                "The robot is less accurate than before: take the values back, then diagnose the model.",
            )
        }
    };
    NextStep::new(status, Some(action), then)
}

fn measure(stage: Stage) -> (Action, &'static str) {
    let (title, then) = match stage {
        Stage::Before => (
            "Measure before",
            "The robot moves to test poses. Then: review what is to be written.",
        ),
        Stage::After => (
            "Measure after",
            "The robot moves to test poses. Then: accept the robot.",
        ),
    };
    (Action::new(title, RobotCommand::Verify(stage)), then)
}

/// A simulated controller gets parameters for effects that it cannot correct yet.
fn missing_parameters(
    model: &Model,
    differences: &[tautline_link::adjusting::Difference],
) -> Option<Action> {
    let kind = model
        .link
        .connected
        .as_ref()
        .map(|connected| connected.rig.kind);
    let mut effects = differences
        .iter()
        .filter(|one| one.name.starts_with("effect."));
    let is_unknown = effects.any(|one| one.controller.is_none());
    (is_unknown && kind == Some(Kind::OfSession)).then(|| {
        Action::new(
            "Add the parameters to the simulated controller",
            RobotCommand::ConnectAndArm,
        )
    })
}
