//! The next step of phase 3: plan, connect, arm, measure.

use super::{Action, NextStep, connecting, identify, plan, waits};
use crate::model::command::{PLANNING, RobotCommand};
use crate::model::link::{LinkRequest, RunLog};
use crate::model::phase::{Phase, Progress};
use crate::model::{Model, OpenSession, phase_status};
use tautline_workflow::wording::sentence;

pub(super) fn of(model: &Model, open: &OpenSession, poses: usize) -> NextStep {
    let session = open.session();
    let status = phase_status::of(model, open, Phase::Measuring);
    if model.tasks.runs(PLANNING) {
        return NextStep::wait("Planning poses.", None, "Then: connect the controller.");
    }
    if let Some(step) = running(model) {
        return step;
    }
    if let Some(waits) = waits(model) {
        return waits;
    }
    let decides = session.settings.until.enabled;
    let has_decided = model.link.run.as_ref().is_some_and(RunLog::has_decided);
    let is_complete = open.missing().is_empty() || decides && has_decided;
    let is_empty = session.measurements.is_empty();
    if is_complete && is_empty && !open.decides_on_poses() {
        let then = "Then: connect the controller and measure.";
        return NextStep::new(status, Some(plan(poses)), then);
    }
    if is_complete && !is_empty {
        let then = "Then: check whether the model explains the readings.";
        return match open.fit_is_current() {
            true => NextStep::new(status, Some(Action::go(Phase::Identification)), ""),
            false => NextStep::new(status, Some(identify()), then),
        };
    }
    if let Some((action, then)) = connecting(model, session) {
        return NextStep::new(status, action, then);
    }
    if let Some(why) = model.undecidable() {
        return NextStep::new(status, None, why);
    }
    let title = match is_empty {
        true => "Start measuring",
        false => "Continue measuring",
    };
    let action = Action::new(title, RobotCommand::Start);
    NextStep::new(status, Some(action), "Then: the robot moves. Stop: F12.")
}

/// A measuring run, paused or not.
fn running(model: &Model) -> Option<NextStep> {
    let run = model.link.run.as_ref().filter(|run| !run.has_ended())?;
    let (done, of) = (run.done(), run.of());
    let share = Some(done as f32 / of.max(1) as f32);
    let Some(reason) = &run.paused else {
        let words = [
            Some(poses_measured(run)),
            model.link.doing().map(|doing| lowercase(&doing)),
            model.link.time_left(),
        ];
        let words: Vec<String> = words.into_iter().flatten().collect();
        let text = format!("{}.", words.join("; "));
        return Some(NextStep::wait(text, share, "Then: identify the pulleys."));
    };
    let resume = Action::new("Resume", LinkRequest::Resume);
    let arm = Action::new("Arm the controller", RobotCommand::Arm);
    let action = match (model.link.is_connected(), model.link.is_armed()) {
        (false, _) => None,
        (true, false) => Some(arm),
        (true, true) => Some(resume),
    };
    Some(NextStep {
        progress: Progress::Attention,
        done: format!("{}; the run is paused.", poses_measured(run)),
        share,
        action,
        then: format!("{}.", sentence(reason.trim_end_matches('.'))),
    })
}

fn poses_measured(run: &RunLog) -> String {
    let (done, of) = (run.done(), run.of());
    match run.until {
        Some(_) => format!("{done} of at most {of} poses measured"),
        None => format!("{done} of {of} poses measured"),
    }
}

/// A sentence as the rest of another.
fn lowercase(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_lowercase);
    first.chain(letters).collect()
}
