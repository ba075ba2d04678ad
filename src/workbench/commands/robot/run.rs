//! The measuring run: a pose is kept on disk before it is in the session, and in the session before the next one begins.

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_session::{MeasuredPose, Phase as LogPhase};

use crate::model::OpenSession;
use crate::model::link::{DriverEvent, Pending};
use crate::shell::State;
use crate::views::robot_3d::Live;
use tautline_workflow::planning::missing;
use tautline_workflow::wording::{self, count};

/// What readings are compared with: the identified model where it is up to date, else the description.
fn model(open: &OpenSession) -> Robot {
    match open.fit().filter(|_| open.fit_is_current()) {
        Some(fit) => fit.model.clone(),
        None => open.session().robot.clone(),
    }
}

pub(super) fn start(state: &mut State) {
    let Some(open) = &mut state.model.open else {
        return;
    };
    if state.model.link.is_busy() || !state.model.link.is_armed() {
        return;
    }
    let session = open.session();
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
    open.log(LogPhase::Poses, text);
    let model = model(open);
    state.model.link.measure(plan, measured, model);
}

pub(super) fn repeat(state: &mut State, label: i64) {
    let Some(open) = &mut state.model.open else {
        return;
    };
    if state.model.link.is_measuring() {
        state.model.link.repeat(label);
    } else if !state.model.link.is_busy() && state.model.link.is_armed() {
        let session = open.session();
        let planned = session.plan.iter().find(|pose| pose.label == label);
        let row = session.measurements.labels.iter().position(|l| *l == label);
        let commanded = row.and_then(|row| session.measurements.commanded.get(row).copied()?);
        let Some(pose) = planned.map(|pose| pose.pose()).or(commanded) else {
            return;
        };
        let model = model(open);
        state
            .model
            .link
            .measure(vec![(label, pose)], Vec::new(), model);
    }
    open.log(LogPhase::Poses, format!("Pose {label} is measured again."));
}

pub(super) fn reported(state: &mut State, report: DriverEvent) {
    if let DriverEvent::Measured(pose, surprise) = report {
        if let Some(run) = &mut state.model.link.run {
            let time_s = pose.readings.time_s.first().copied();
            run.measured(pose.label(), time_s.unwrap_or(f64::NAN));
            run.surprises.extend(surprise);
        }
        measured(state, *pose);
        return;
    }
    let Some(run) = &mut state.model.link.run else {
        return;
    };
    match report {
        DriverEvent::Commanded(label) => {
            run.current = Some(label);
            run.paused = None;
        }
        DriverEvent::Warning(warning) => run.warnings.push(warning),
        DriverEvent::Skipped(label) => {
            run.skipped.insert(label);
            run.paused = None;
            log(state, format!("Pose {label} was left out."));
        }
        DriverEvent::Paused(reason) => run.paused = Some(reason),
        DriverEvent::Resumed => run.paused = None,
        DriverEvent::RunEnded(result) => ended(state, result),
        _ => {}
    }
}

fn ended(state: &mut State, result: Result<(), String>) {
    let Some(run) = &mut state.model.link.run else {
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
        Ok(()) => state.model.messages.info(&text),
        Err(_) => state.model.messages.warning(&text),
    }
    run.ended = Some(result);
    log(state, text);
}

fn log(state: &mut State, text: String) {
    if let Some(open) = &mut state.model.open {
        open.log(LogPhase::Poses, text);
    }
}

/// Hands a measured pose to the keeper.
fn measured(state: &mut State, pose: MeasuredPose) {
    let Some(open) = &mut state.model.open else {
        return;
    };
    let session = open.session();
    let label = pose.label();
    let pose = match session.measurements.labels.contains(&label) {
        true => pose.repeated_as(session.next_label()),
        false => pose,
    };
    // Only what is unsaved is kept, and what was measured is so.
    if !open.is_unsaved() {
        open.log(
            LogPhase::Poses,
            format!("Pose {} was measured.", pose.label()),
        );
    }
    state.model.autosave.follow(state.model.open.as_ref());
    state.model.autosave.measured(pose.clone());
    state.model.link.pending = Some(Pending {
        label,
        pose,
        failed: false,
    });
}

/// A pose is on disk: it comes into the session, and the run may go on.
pub fn kept(state: &mut State, label: i64) {
    let is_it = |pending: &mut Pending| pending.pose.label() == label;
    let Some(pending) = state.model.link.pending.take_if(is_it) else {
        return;
    };
    let Some(open) = &mut state.model.open else {
        return;
    };
    if let Err(error) = open.append_pose(&pending.pose) {
        state.model.messages.error(format!(
            "Pose {} cannot be used: {error}.",
            pending.pose.label()
        ));
        state.model.link.abort();
        return;
    }
    state.model.link.stored(pending.label);
}

/// A pose could not be kept: the run waits with it.
pub fn not_kept(state: &mut State) {
    if let Some(pending) = &mut state.model.link.pending {
        pending.failed = true;
    }
}

pub(super) fn keep_again(state: &mut State) {
    if let Some(pending) = state
        .model
        .link
        .pending
        .as_mut()
        .filter(|pending| pending.failed)
    {
        pending.failed = false;
        state.model.autosave.measured(pending.pose.clone());
    }
}

/// Draws the robot where it is while something goes on.
pub(super) fn draw(state: &mut State) {
    if !state.model.link.is_connected() {
        return;
    }
    let drawn = &mut state.views.robot_3d.live;
    let follows = &mut state.views.timeline.follows;
    if !state.model.link.is_busy() && !state.model.link.watches {
        *drawn = None;
        *follows = true;
        return;
    }
    if !*follows {
        *drawn = None;
        return;
    }
    let live = state.model.link.live();
    let (Some(pose), Some(open)) = (live.pose, &state.model.open) else {
        return;
    };
    let forces = live.sample.map_or_else(Vec::new, |sample| sample.force_n);
    let cables = open.session().robot.cables.iter();
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
