//! The next step of phase 5, along its checklist.

use tautline_link::adjusting::Difference;
use tautline_session::{Outcome, Session, Stage};

use super::{NextStep, Problem, Remedy, connecting, identification, of_controller, status};
use crate::model::command::{ReportCommand, RobotCommand};
use crate::model::phase::{Phase, PhaseStatus, Progress};
use crate::model::{Model, OpenSession};
use tautline_workflow::accuracy::{LARGEST, before_and_after};
use tautline_workflow::adjusting::{self, AdjustmentStep, Check, CheckState};
use tautline_workflow::controllers::RobotKind;
use tautline_workflow::report::ReportFormat;
use tautline_workflow::wording::{count, sentence};

/// Problems of the identified values, the controller, and the last adjustment and verification.
pub(super) fn problems(model: &Model, open: &OpenSession) -> Vec<Problem> {
    let session = open.session();
    let mut problems: Vec<Problem> = of_values(model, open).into_iter().collect();
    problems.extend(of_controller(model));
    let review = model.review();
    let with_controller = |text: &str, remedy: Remedy| {
        Problem::new(text, connecting(model, session).unwrap_or(remedy))
    };
    problems.extend(
        match session.adjustments().last().map(|last| &last.outcome) {
            Some(Outcome::Failed(why)) if !open.fit_is_current() => {
                Some(Problem::new(why, unidentified(open)))
            }
            Some(Outcome::Failed(why)) => Some(with_controller(why, write(session, &review.lines))),
            Some(Outcome::Begun | Outcome::Unsettled(_)) => {
                let text = model.unsettled().unwrap_or_default();
                let then = "Until then, nothing moves and nothing is written.";
                let title = "Settle the interrupted values";
                let settle = Remedy::new(title, RobotCommand::Arm, then);
                Some(with_controller(&text, settle))
            }
            _ => None,
        },
    );
    problems.extend(adjusting::refusal(&review.lines).map(|why| {
        let end = Remedy::by_hand("End the correction at the controller first.");
        Problem::new(sentence(&why), end)
    }));
    let is_worse = |check: &Check| check.state == CheckState::Bad;
    if open.checklist(&review.lines).iter().any(is_worse) {
        let text = "The robot is less accurate than before.";
        let then = "Roll back the values, then diagnose the model.";
        let back = Remedy::new("Roll back the values", RobotCommand::RollBack, then);
        problems.push(with_controller(text, back));
    }
    if let Err(error) = before_and_after(session) {
        problems.push(with_controller(&error, measure(session, Stage::After)));
    }
    problems
}

/// Problem in phase 4 that affects the values to be written.
#[must_use]
pub fn of_values(model: &Model, open: &OpenSession) -> Option<Problem> {
    if !open.fit_is_current() {
        return None;
    }
    let problem = identification::of_values(model, open).into_iter().next()?;
    let then = "Its values can make the robot less accurate.";
    let go = Remedy::go(Phase::Identification, then);
    Some(Problem::new(problem.text, go))
}

/// Step before anything can be written: measure the poses or identify the pulleys.
fn unidentified(open: &OpenSession) -> Remedy {
    let then = match open.fit() {
        Some(_) => "The data changed after the last identification.",
        None => "There is nothing to write before the pulleys are identified.",
    };
    match open.session().measurements.is_empty() {
        true => Remedy::go(Phase::Measuring, then),
        false => super::identify(then),
    }
}

pub(super) fn of(model: &Model, open: &OpenSession) -> NextStep {
    let status = status(model, open, Phase::Adjustment);
    if !open.fit_is_current() {
        return NextStep::new(status, unidentified(open));
    }
    let review = model.review();
    let checks = open.checklist(&review.lines);
    let next = checks.iter().find(|check| check.state == CheckState::Next);
    let Some(next) = next.map(|check| check.step) else {
        let title = match ReportFormat::FOR_PAPER {
            ReportFormat::Pdf => "Save report as PDF…",
            _ => "Save report as HTML…",
        };
        let save = ReportCommand::AskSave(ReportFormat::FOR_PAPER);
        let status = PhaseStatus::new(
            Progress::Done,
            "the robot is adjusted, verified and accepted",
        );
        return NextStep::new(status, Remedy::new(title, save, "Then: save the session."));
    };
    if next == AdjustmentStep::Accept {
        let figures = before_and_after(open.session()).unwrap_or_default();
        let largest = figures.iter().find(|one| one.name == LARGEST);
        let then = match largest.and_then(|one| one.after_m) {
            Some(m) => format!("It is accepted with errors of at most {:.2} mm.", 1e3 * m),
            None => "Then: save the report.".to_owned(),
        };
        let accept = Remedy::new("Accept the robot", RobotCommand::Accept, then);
        return NextStep::new(status, accept);
    }
    let session = open.session();
    if let Some(remedy) = connecting(model, session) {
        return NextStep::new(status, remedy);
    }
    let remedy = match next {
        AdjustmentStep::MeasureBefore => missing_parameters(model, &review.lines)
            .unwrap_or_else(|| measure(session, Stage::Before)),
        AdjustmentStep::Review | AdjustmentStep::Write => write(session, &review.lines),
        AdjustmentStep::MeasureAfter | AdjustmentStep::Accept => measure(session, Stage::After),
    };
    NextStep::new(status, remedy)
}

/// Writes the values that differ; without differences, measures instead.
fn write(session: &Session, differences: &[Difference]) -> Remedy {
    let changes = differences.iter().filter(|one| one.is_writable_change());
    match changes.count() {
        0 => measure(session, Stage::After),
        changes => {
            let title = format!("Write {}…", count(changes, "value"));
            let then = "You are asked for your name before anything is written.";
            Remedy::new(title, RobotCommand::Write, then)
        }
    }
}

fn measure(session: &Session, stage: Stage) -> Remedy {
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
    let title = match adjusting::to_continue(session, stage) {
        Some(run) => format!("{title}: continue ({} of {})", run.rows.len(), run.planned),
        None => title.to_owned(),
    };
    Remedy::new(title, RobotCommand::Verify(stage), then)
}

/// Adds the missing parameters for effects to a simulated controller.
fn missing_parameters(model: &Model, differences: &[Difference]) -> Option<Remedy> {
    let mut effects = differences
        .iter()
        .filter(|one| one.name.starts_with("effect."));
    let is_unknown = effects.any(|one| one.controller.is_none());
    (is_unknown && model.robot_kind() == Some(RobotKind::OfSession)).then(|| {
        Remedy::new(
            "Add the parameters to the simulated controller",
            RobotCommand::ConnectAndArm,
            "The controller gets parameters for what the doctor found.",
        )
    })
}
