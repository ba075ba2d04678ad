//! The measuring run: a pose is kept on disk before it is in the session, and in the session before the next one begins.

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_link::measuring::Accepted;
use tautline_session::Phase;

use crate::app::Document;
use crate::app::robot::{Pending, Report};
use crate::app::state::State;
use crate::views::robot_3d::Live;
use tautline_workflow::planning::missing;
use tautline_workflow::wording::{self, count};

/// What readings are compared with: the identified model where it is up to date, else the description.
fn model(document: &Document) -> Robot {
    match document.fit().filter(|_| document.fit_is_current()) {
        Some(fit) => fit.model.clone(),
        None => document.session().robot.clone(),
    }
}

pub(super) fn start(state: &mut State) {
    let Some(document) = &mut state.document else {
        return;
    };
    if state.link.is_busy() || !state.link.is_armed() {
        return;
    }
    let session = document.session();
    let missing = missing(session);
    if missing == 0 {
        return;
    }
    let planned = session.plan.iter();
    let plan: Vec<(i64, Pose)> = planned.map(|pose| (pose.label, pose.pose())).collect();
    let measured = session.measurements.labels.clone();
    let text = match measured.len() {
        0 => format!("Measuring of {} started.", count(missing, "pose")),
        _ => format!("Measuring continued with {}.", count(missing, "pose")),
    };
    document.log(Phase::Poses, text);
    let model = model(document);
    state.link.measure(plan, measured, model);
}

pub(super) fn repeat(state: &mut State, label: i64) {
    let Some(document) = &mut state.document else {
        return;
    };
    if state.link.is_measuring() {
        state.link.repeat(label);
    } else if !state.link.is_busy() && state.link.is_armed() {
        let session = document.session();
        let planned = session.plan.iter().find(|pose| pose.label == label);
        let row = session.measurements.labels.iter().position(|l| *l == label);
        let commanded = row.and_then(|row| session.measurements.commanded.get(row).copied()?);
        let Some(pose) = planned.map(|pose| pose.pose()).or(commanded) else {
            return;
        };
        let model = model(document);
        state.link.measure(vec![(label, pose)], Vec::new(), model);
    }
    document.log(Phase::Poses, format!("Pose {label} is measured again."));
}

pub(super) fn reported(state: &mut State, report: Report) {
    if let Report::Measured(accepted, surprise) = report {
        if let Some(run) = &mut state.link.run {
            run.measured(accepted.label, accepted.time_s);
            run.surprises.extend(surprise);
        }
        measured(state, &accepted);
        return;
    }
    let Some(run) = &mut state.link.run else {
        return;
    };
    match report {
        Report::Commanded(label) => {
            run.current = Some(label);
            run.paused = None;
        }
        Report::Warning(warning) => run.warnings.push(warning),
        Report::Skipped(label) => {
            run.skipped.insert(label);
            run.paused = None;
            log(state, format!("Pose {label} was left out."));
        }
        Report::Paused(reason) => run.paused = Some(reason),
        Report::Resumed => run.paused = None,
        Report::RunEnded(result) => ended(state, result),
        _ => {}
    }
}

fn ended(state: &mut State, result: Result<(), String>) {
    let Some(run) = &mut state.link.run else {
        return;
    };
    let done = count(run.done(), "pose");
    let text = match &result {
        Ok(()) => format!("Measured {done}."),
        Err(why) => format!(
            "Measuring ended after {done}: {}.",
            why.trim_end_matches('.')
        ),
    };
    run.current = None;
    run.paused = None;
    match result {
        Ok(()) => state.messages.info(&text),
        Err(_) => state.messages.warning(&text),
    }
    run.ended = Some(result);
    log(state, text);
}

fn log(state: &mut State, text: String) {
    if let Some(document) = &mut state.document {
        document.log(Phase::Poses, text);
    }
}

/// Hands a measured pose to the keeper.
fn measured(state: &mut State, accepted: &Accepted) {
    let Some(document) = &mut state.document else {
        return;
    };
    let session = document.session();
    let again = session.measurements.labels.contains(&accepted.label);
    let mut pose = accepted.measured_pose();
    if again {
        pose.repeats = Some(accepted.label);
        pose.label = session.next_label();
    }
    // Only what is unsaved is kept, and what was measured is so.
    if !document.is_unsaved() {
        document.log(Phase::Poses, format!("Pose {} was measured.", pose.label));
    }
    state.keeping.follow(state.document.as_ref());
    state.keeping.measured(pose.clone());
    state.link.pending = Some(Pending {
        label: accepted.label,
        pose,
        failed: false,
    });
}

/// A pose is on disk: it comes into the session, and the run may go on.
pub fn kept(state: &mut State, label: i64) {
    let is_it = |pending: &mut Pending| pending.pose.label == label;
    let Some(pending) = state.link.pending.take_if(is_it) else {
        return;
    };
    let Some(document) = &mut state.document else {
        return;
    };
    if let Err(error) = document.append_pose(&pending.pose) {
        state.messages.error(format!(
            "Pose {} cannot be used: {error}.",
            pending.pose.label
        ));
        state.link.abort();
        return;
    }
    state.link.stored(pending.label);
}

/// A pose could not be kept: the run waits with it.
pub fn not_kept(state: &mut State) {
    if let Some(pending) = &mut state.link.pending {
        pending.failed = true;
    }
}

pub(super) fn keep_again(state: &mut State) {
    if let Some(pending) = state.link.pending.as_mut().filter(|pending| pending.failed) {
        pending.failed = false;
        state.keeping.measured(pending.pose.clone());
    }
}

/// Draws the robot where it is while something goes on.
pub(super) fn draw(state: &mut State) {
    if !state.link.is_connected() {
        return;
    }
    let drawn = &mut state.views.robot_3d.live;
    let follows = &mut state.views.timeline.follows;
    if !state.link.is_busy() && !state.link.watches {
        *drawn = None;
        *follows = true;
        return;
    }
    if !*follows {
        *drawn = None;
        return;
    }
    let live = state.link.live();
    let (Some(pose), Some(document)) = (live.pose, &state.document) else {
        return;
    };
    let forces = live.sample.map_or_else(Vec::new, |sample| sample.force_n);
    let cables = document.session().robot.cables.iter();
    let tensions_n = cables.zip(forces).map(|(cable, force)| {
        let sensor = cable.force_sensor;
        sensor.map_or(f64::NAN, |sensor| sensor.tension_n(force))
    });
    *drawn = Some(Live {
        pose,
        tensions_n: tensions_n.collect(),
    });
}

/// The reason of a pause as a sentence.
#[must_use]
pub fn sentence(reason: &str) -> String {
    format!("{}.", wording::sentence(reason.trim_end_matches('.')))
}
