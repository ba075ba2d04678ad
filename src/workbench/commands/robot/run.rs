//! Measuring run: a pose is on disk before it is in the session, and in the session before the next one begins.

use std::sync::Arc;

use tautline_core::geometry::Pose;
use tautline_link::ParameterInfo;
use tautline_session::{MeasuredPose, MeasuringWarning, Phase as LogPhase};

use super::adjust::not_recorded;
use super::moving::{reference, refuses, watch};
use super::until;
use crate::model::Model;
use crate::model::link::{DriverCommand, DriverEvent, LivePlatform, PendingPose, RunLog};
use tautline_workflow::clock;
use tautline_workflow::foreign_writes::{ValuesRead, begin_run, end_run};
use tautline_workflow::planning::poses_in_words;
use tautline_workflow::sequential::SequentialRun;

pub(super) fn start(model: &mut Model) {
    if refuses(model) {
        return;
    }
    let Some(open) = &mut model.open else {
        return;
    };
    if model.link.is_busy() || !model.link.is_armed() {
        return;
    }
    let session = open.session();
    if session.settings.until.enabled {
        return until::start(model);
    }
    if open.missing().is_empty() {
        return;
    }
    let missing = poses_in_words(open.missing().iter().copied());
    let planned = session.plan.iter();
    let plan: Vec<(i64, Pose)> = planned.map(|pose| (pose.label, pose.pose())).collect();
    let measured = session.measurements.labels.clone();
    let text = match measured.len() {
        0 => format!("Measuring of {missing} started."),
        _ => format!("Measuring continued with {missing}."),
    };
    open.log(LogPhase::Poses, text);
    let reference = reference(open);
    model.link.measure(plan, measured, reference, None);
    watch(model);
}

pub(super) fn repeat(model: &mut Model, label: i64) {
    if refuses(model) {
        return;
    }
    let Some(open) = &mut model.open else {
        return;
    };
    if model.link.is_measuring() {
        model.link.repeat(label);
    } else if !model.link.is_busy() && model.link.is_armed() {
        let session = open.session();
        let planned = session.plan.iter().find(|pose| pose.label == label);
        let row = session.measurements.labels.iter().position(|l| *l == label);
        let commanded = row.and_then(|row| session.measurements.commanded.get(row).copied()?);
        let Some(pose) = planned.map(|pose| pose.pose()).or(commanded) else {
            return;
        };
        let reference = reference(open);
        let plan = vec![(label, pose)];
        model.link.measure(plan, Vec::new(), reference, None);
        watch(model);
    }
    log(model, format!("Pose {label} is measured again."));
}

pub(super) fn receive(model: &mut Model, event: DriverEvent) {
    if let DriverEvent::Measured(pose, surprise) = event {
        if let Some(run) = &mut model.link.run {
            let time_s = pose.readings.time_s.first().copied();
            run.measured(pose.label(), time_s.unwrap_or(f64::NAN));
            run.surprises.extend(surprise);
        }
        measured(model, *pose);
        return;
    }
    match &event {
        DriverEvent::ValuesAtStart(values) => return values_at_start(model, values),
        DriverEvent::ValuesAtEnd(values) => return compare(model, values),
        _ => {}
    }
    let Some(run) = &mut model.link.run else {
        return;
    };
    match event {
        DriverEvent::Commanded(label) => {
            run.current = Some(label);
            run.paused = None;
        }
        DriverEvent::Warning(warning) => run.warnings.push(warning),
        DriverEvent::Skipped(label) => {
            run.skipped.insert(label);
            run.paused = None;
            if let (Some(until), Some(open)) = (&mut run.until, &model.open) {
                run.current = None;
                until.leave_out(label, open.session());
            }
            log(model, format!("Pose {label} was left out."));
        }
        DriverEvent::Paused(reason) => run.paused = Some(reason),
        DriverEvent::Resumed => run.paused = None,
        DriverEvent::RunEnded(result) => ended(model, result),
        DriverEvent::RunRestarted(why) => {
            run.restarted = true;
            ended(model, Err(why));
        }
        _ => {}
    }
}

/// Records the controller values before a run moves, or continues after a lost connection.
pub(super) fn values_at_start(model: &mut Model, values: &[ParameterInfo]) {
    let mut changed = None;
    let read = ValuesRead {
        controller: &model.link.identity,
        parameters: values,
    };
    if let Some(open) = &mut model.open {
        open.record(|session| changed = begin_run(session, read, clock::now()));
    }
    tell_foreign_write(model, changed);
    model.autosave.follow(model.open.as_ref());
}

/// Compares the controller values with those at the start of the last run.
pub(super) fn compare(model: &mut Model, values: &[ParameterInfo]) {
    let mut changed = None;
    let pending = model.link.pending.as_ref();
    let pending = pending.map(|pending| pending.pose.label());
    let read = ValuesRead {
        controller: &model.link.identity,
        parameters: values,
    };
    let open = model.open.as_mut();
    if let Some(open) = open.filter(|open| open.session().is_run_open(read.controller)) {
        open.record(|session| changed = end_run(session, read, pending, clock::now()));
    }
    tell_foreign_write(model, changed);
}

fn tell_foreign_write(model: &mut Model, text: Option<String>) {
    if let Some(text) = text {
        model.messages.warning(&text);
        log(model, text);
    }
}

fn ended(model: &mut Model, result: Result<(), String>) {
    let Some(run) = &mut model.link.run else {
        return;
    };
    let done = run.measured_in_words();
    let result = match run.undecided.take() {
        Some(why) => result.and(Err(why)),
        None => result,
    };
    let end = run.until.as_ref().and_then(SequentialRun::end);
    let text = match &result {
        Ok(()) => format!(
            "Measured {done}{}.",
            end.map_or_else(String::new, |end| format!(", {end}"))
        ),
        Err(why) => format!(
            "Measuring ended after {done}: {}.",
            why.trim_end_matches('.')
        ),
    };
    run.current = None;
    run.paused = None;
    match result {
        Ok(()) => model.messages.info(&text),
        Err(_) => {
            model.link.is_stopped = true;
            model.messages.warning(&text);
        }
    }
    run.ended = Some(result);
    log(model, text);
}

fn log(model: &mut Model, text: String) {
    if let Some(open) = &mut model.open {
        open.log(LogPhase::Poses, text);
    }
}

/// Sends a measured pose to the autosave.
fn measured(model: &mut Model, pose: MeasuredPose) {
    let Some(open) = &mut model.open else {
        return;
    };
    let session = open.session();
    let label = pose.label();
    let pose = match session.measurements.labels.contains(&label) {
        true => pose.repeated_as(session.next_label()),
        false => pose,
    };
    // The autosave keeps only unsaved sessions, so the session has to be unsaved.
    if !open.is_unsaved() {
        open.log(
            LogPhase::Poses,
            format!("Pose {} was measured.", pose.label()),
        );
    }
    let warnings = model.link.run.as_mut().map(RunLog::take_new_warnings);
    let warnings: Vec<MeasuringWarning> = (warnings.into_iter().flatten())
        .filter(|warning| warning.label == label)
        .map(|warning| MeasuringWarning {
            pose: pose.label(),
            text: warning.text,
        })
        .collect();
    if !warnings.is_empty() {
        open.record(|session| session.add_measuring_warnings(warnings));
    }
    model.autosave.follow(model.open.as_ref());
    model.autosave.measured(pose.clone());
    model.link.pending = Some(PendingPose {
        label,
        pose,
        failed: false,
    });
}

/// Adds a pose that is on disk to the session and lets the run continue.
pub fn autosaved(model: &mut Model, label: i64) {
    let is_it = |pending: &mut PendingPose| pending.pose.label() == label;
    let Some(pending) = model.link.pending.take_if(is_it) else {
        return;
    };
    let Some(open) = &mut model.open else {
        return;
    };
    if let Err(error) = open.append_pose(&pending.pose) {
        model.messages.error(format!(
            "Pose {} cannot be used: {error}.",
            pending.pose.label()
        ));
        model.link.stop();
        return;
    }
    model.link.send(DriverCommand::Stored(pending.label));
    if let Some(run) = model.link.run.as_mut().filter(|run| !run.has_ended())
        && let Some(until) = &mut run.until
    {
        run.current = None;
        until.measured(pending.label, open.session());
    }
}

/// Keeps the run waiting with a pose that could not be stored.
pub fn autosave_failed(model: &mut Model) {
    not_recorded(model);
    if let Some(pending) = &mut model.link.pending {
        pending.failed = true;
    }
}

pub(super) fn retry_save(model: &mut Model) {
    if let Some(pending) = model.link.pending.as_mut().filter(|pending| pending.failed) {
        pending.failed = false;
        model.autosave.measured(pending.pose.clone());
    }
}

/// Updates the live platform while the views follow it.
pub(super) fn follow_platform(model: &mut Model) {
    if !model.link.is_connected() {
        return;
    }
    let is_idle = !model.link.is_busy() && !model.link.polls_when_idle;
    let is_stopped = is_idle && model.link.is_stopped;
    model.playback.follows |= is_idle && !is_stopped;
    if (is_idle && !is_stopped) || !model.playback.follows {
        model.live_platform = None;
        return;
    }
    let live = model.link.live();
    let (Some(pose), Some(open)) = (live.pose, &model.open) else {
        return;
    };
    let forces = live.sample.map_or_else(Vec::new, |sample| sample.force_n);
    let cables = open.session().robot.cables.iter();
    let tensions_n = cables.zip(forces).map(|(cable, force)| {
        let sensor = cable.force_sensor;
        sensor.map_or(f64::NAN, |sensor| sensor.tension_n(force))
    });
    model.link.trail.follow(pose.position);
    model.live_platform = Some(LivePlatform {
        pose,
        trail: Arc::clone(model.link.trail.places()),
        is_stopped,
        tensions_n: tensions_n.collect(),
    });
}
