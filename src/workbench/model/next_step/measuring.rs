//! Next step of phase 3: plan, connect, arm, measure.

use super::{NextStep, Problem, Remedy, connecting, identify, of_controller, plan, status};
use crate::model::command::{ImportCommand, RobotCommand};
use crate::model::link::{LinkRequest, RunLog};
use crate::model::phase::{Phase, Progress};
use crate::model::{Model, OpenSession};
use tautline_workflow::precalibration::Table;
use tautline_workflow::wording::sentence;

pub(super) fn of(model: &Model, open: &OpenSession, poses: usize) -> NextStep {
    if let Some(step) = paused(model) {
        return step;
    }
    let session = open.session();
    let status = status(model, open, Phase::Measuring);
    let decides = session.settings.until.enabled;
    let has_decided = model.link.run.as_ref().is_some_and(RunLog::has_decided);
    let is_complete = open.missing().is_empty() || decides && has_decided;
    let is_empty = session.measurements.is_empty();
    if is_complete && is_empty && !open.decides_on_poses() {
        let then = "Then: connect the controller and measure.";
        return NextStep::new(status, plan(poses, then));
    }
    if is_complete && !is_empty {
        let then = "Then: check whether the model explains the readings.";
        return match open.fit_is_current() {
            true => NextStep::new(status, Remedy::go(Phase::Identification, "")),
            false => NextStep::new(status, identify(then)),
        };
    }
    if let Some(remedy) = connecting(model, session) {
        return NextStep::new(status, remedy);
    }
    if let Some(why) = model.undecidable() {
        return NextStep::new(status, Remedy::by_hand(why));
    }
    let title = match is_empty {
        true => "Start measuring",
        false => "Continue measuring",
    };
    let then = "Then: the robot moves. Stop: F12.";
    NextStep::new(status, Remedy::new(title, RobotCommand::Start, then))
}

/// Problems before and during measuring.
pub(super) fn problems(model: &Model, open: &OpenSession) -> Vec<Problem> {
    let problems = failed_save(model).into_iter().chain(no_home(open));
    problems.chain(of_controller(model)).collect()
}

/// Measured pose that could not be stored.
#[must_use]
pub fn failed_save(model: &Model) -> Option<Problem> {
    let pending = model.link.pending.as_ref();
    let label = pending.filter(|pending| pending.failed)?.pose.label();
    let text = format!(
        "Pose {label} was measured but could not be saved. The run is paused: free disk space or fix permissions, then retry."
    );
    let then = "Then: the run goes on.";
    let retry = Remedy::new("Retry save", RobotCommand::RetrySave, then);
    Some(Problem::new(text, retry))
}

/// Missing home pose, to which revolutions refer.
#[must_use]
pub fn no_home(open: &OpenSession) -> Option<Problem> {
    let session = open.session();
    if session.robot.home.is_some() || !session.measurements.length_m.is_empty() {
        return None;
    }
    let text = "This robot has no home pose, so revolutions have no reference. Measure it first.";
    let then = "On the home platform, or with another instrument.";
    let show = ImportCommand::Show(Table::Home);
    Some(Problem::new(
        text,
        Remedy::new("Measure the home pose", show, then),
    ))
}

/// Running measurement without a problem.
pub(super) fn running(model: &Model) -> Option<NextStep> {
    let run = model.link.run.as_ref()?;
    if run.paused.is_some() || failed_save(model).is_some() {
        return None;
    }
    let words = [
        Some(poses_measured(run)),
        model.link.doing().map(|doing| lowercase(&doing)),
        model.link.time_left(),
    ];
    let words: Vec<String> = words.into_iter().flatten().collect();
    let text = format!("{}.", words.join("; "));
    let then = "Then: identify the pulleys.";
    Some(NextStep::wait(text, Some(share(run)), then))
}

/// Paused measurement.
fn paused(model: &Model) -> Option<NextStep> {
    let run = model.link.run.as_ref().filter(|run| !run.has_ended())?;
    let reason = run.paused.as_ref()?;
    let then = format!("{}.", sentence(reason.trim_end_matches('.')));
    let remedy = match (model.link.is_connected(), model.link.is_armed()) {
        (false, _) => Remedy::by_hand(then),
        (true, false) => Remedy::new("Arm the controller", RobotCommand::Arm, then),
        (true, true) => Remedy::new("Resume", LinkRequest::Resume, then),
    };
    Some(NextStep {
        progress: Progress::Attention,
        done: format!("{}; the run is paused.", poses_measured(run)),
        share: Some(share(run)),
        action: remedy.action,
        then: remedy.then,
    })
}

fn share(run: &RunLog) -> f32 {
    run.done() as f32 / run.of().max(1) as f32
}

fn poses_measured(run: &RunLog) -> String {
    let (done, of) = (run.done(), run.of());
    match run.until {
        Some(_) => format!("{done} of at most {of} poses measured"),
        None => format!("{done} of {of} poses measured"),
    }
}

/// Sentence with a small initial, to follow other text.
fn lowercase(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_lowercase);
    first.chain(letters).collect()
}
