//! Measuring until goals are reached: each pose is chosen from the results of those before.

use tautline_session::Phase as LogPhase;
use tautline_workflow::planning::missing_labels;
use tautline_workflow::sequential::{SequentialRun, UntilRequest, goals_in_words, plan_home};
use tautline_workflow::wording::sentence;

use super::moving::{reference, watch};
use crate::model::Model;
use crate::model::link::DriverCommand;
use crate::model::messages::Cause;

/// Starts a run, or continues after the measured poses.
pub(super) fn start(model: &mut Model) {
    let context = model.context.clone();
    if let Some(why) = model.undecidable() {
        return model.messages.failure(Cause::Planning, why);
    }
    let Some(open) = &mut model.open else {
        return;
    };
    let request = UntilRequest::of_session(open.session());
    let text = format!(
        "Measuring until {}, at most {} poses.",
        goals_in_words(&request.goals),
        request.at_most
    );
    let wake = move || context.request_repaint();
    let mut until = match SequentialRun::start(open.session(), request, wake) {
        Ok(until) => until,
        Err(error) => {
            let text = format!("No pose can be decided on: {error}.");
            return model.messages.failure(Cause::Planning, text);
        }
    };
    model.messages.resolve(Cause::Planning);
    open.extend_plan(plan_home);
    open.log(LogPhase::Poses, text);
    let session = open.session();
    let measured = session.measurements.labels.clone();
    let is_home_open = missing_labels(session).any(|label| label == 0);
    let home = session.plan.iter().filter(|planned| planned.label == 0);
    let home: Vec<_> = home.map(|planned| (0, planned.pose())).collect();
    if !is_home_open {
        until.ask(session);
    }
    let is_used = |label: &&i64| **label != 0 && !session.excluded().contains(label);
    let before = measured.iter().filter(is_used).count();
    let reference = reference(open);
    let until = Some((until, before));
    model.link.measure(home, measured, reference, until);
    watch(model);
}

/// Sends the run to the chosen pose, or ends it.
pub(super) fn follow_decision(model: &mut Model) {
    let Some(run) = model.link.run.as_mut().filter(|run| !run.has_ended()) else {
        return;
    };
    let (Some(until), Some(open)) = (&mut run.until, &mut model.open) else {
        return;
    };
    let decision = match until.poll() {
        None => return,
        Some(Ok(decision)) => decision,
        Some(Err(error)) => {
            run.undecided = Some(sentence(&error));
            return model.link.send(DriverCommand::Close);
        }
    };
    let chosen = open.extend_plan(|session| until.follow(decision, session));
    let Some(chosen) = chosen else {
        return model.link.send(DriverCommand::Close);
    };
    open.log(LogPhase::Poses, chosen.log_text());
    // The pose must be in the stored plan before its readings are.
    model.autosave.follow(model.open.as_ref());
    let add = DriverCommand::Add(chosen.label, chosen.pose);
    model.link.send(add);
}
