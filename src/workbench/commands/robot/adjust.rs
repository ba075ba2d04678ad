//! Adjustment of the controller, and verification of the robot before and after it.

use std::sync::Arc;

use tautline_link::adjusting::{Adjustment as Written, ControllerValues};
use tautline_link::verifying::{VerifyingOptions, are_first_rows, circle, cube_poses, line};
use tautline_session::{
    CheckRow, NamedValue, Outcome, Phase as LogPhase, Stage, StoppedVerification, Verification,
};

use super::moving::{refuses, watch};
use crate::model::Model;
use crate::model::command::WriteDraft;
use crate::model::link::{Connected, DriverCommand, ValuesToWrite};
use crate::model::messages::{Cause, full_sentence};
use tautline_workflow::adjusting::title;
use tautline_workflow::adjusting::{self, Purpose};
use tautline_workflow::clock;
use tautline_workflow::wording::sentence;

/// Number of points of the circle and of the line.
const POINTS: (usize, usize) = (16, 9);

pub(super) fn write(model: &mut Model) {
    let open = model.open.as_ref().filter(|_| model.link.is_connected());
    let Some((session, fit)) = open.and_then(|open| Some((open.session(), open.fit()?))) else {
        return;
    };
    let review = model.review();
    if let Some(why) = adjusting::refusal(&review.lines) {
        let why = full_sentence(&why);
        return model.messages.failure(Cause::Adjustment, why);
    }
    let mut doubts = adjusting::doubts(session, fit);
    doubts.extend(review.doubt());
    let operator = model.preferences.operator.clone();
    model.dialogs.writing = review.changes().next().is_some().then_some(WriteDraft {
        review: Arc::clone(&review),
        doubts,
        operator,
    });
}

pub(super) fn confirm_write(model: &mut Model, is_confirmed: bool) {
    let Some(draft) = model.dialogs.writing.take() else {
        return;
    };
    let operator = draft.operator.trim().to_owned();
    model.change_preferences(|preferences| preferences.operator = operator);
    if !is_confirmed {
        return;
    }
    // The review is a new object after any change.
    if !Arc::ptr_eq(&draft.review, &model.review()) {
        let text = "Nothing was written: model, session or controller changed while the values were shown.";
        return model.messages.failure(Cause::Adjustment, text);
    }
    if let Some(open) = &mut model.open {
        for doubt in draft.doubts {
            let text = format!("Written all the same: {}.", doubt.sentence);
            open.log(LogPhase::Controller, text);
        }
    }
    give(model, draft.review.values_to_write(), Purpose::Adjust);
}

/// Accepts the robot in the name of the operator who wrote the values.
pub(super) fn accept(model: &mut Model) {
    let operator = model.preferences.operator.clone();
    let Some(open) = &mut model.open else {
        return;
    };
    open.record(|session| session.accept(operator.as_str(), clock::now()));
    let text = match operator.as_str() {
        "" => "The robot was accepted.".to_owned(),
        name => format!("The robot was accepted by {name}."),
    };
    open.log(LogPhase::Accuracy, &text);
    model.messages.info(text);
}

pub(super) fn roll_back(model: &mut Model) {
    let values = model
        .revertible()
        .map_or_else(Vec::new, adjusting::former_values);
    let open = model.open.as_ref().filter(|_| values.is_empty());
    if let Some(kept) = open.and_then(|open| adjusting::not_restored(open.session())) {
        model.messages.failure(Cause::Adjustment, &kept);
    }
    give(model, values, Purpose::RollBack);
}

/// Records the attempt; the values are written once the record is on disk.
pub(super) fn give(model: &mut Model, values: Vec<(String, f64)>, purpose: Purpose) {
    if values.is_empty() || model.link.is_busy() || !model.link.is_armed() || refuses(model) {
        return;
    }
    let Some(open) = &mut model.open else {
        return;
    };
    let by = (
        model.link.identity.clone(),
        model.preferences.operator.clone(),
    );
    let record = adjusting::begun(by, &model.link.parameters, &values, purpose, clock::now());
    let [old, new] = adjusting::old_and_new(&record);
    open.record(|session| session.add_adjustment(record));
    model.link.prepare(ValuesToWrite { old, new, purpose });
    model.autosave.follow(model.open.as_ref());
    model.autosave.tell();
}

/// Writes the values: the record of the attempt is on disk.
pub fn recorded(model: &mut Model) {
    model.link.write();
}

/// Cancels the write: the record of the attempt could not be stored.
pub(super) fn not_recorded(model: &mut Model) {
    if model.link.to_write.take().is_some() {
        model.link.writing = false;
        let text = "Nothing was written: its record cannot be saved to disk.";
        conclude(model, Outcome::Failed(text.to_owned()), text, None);
        model.messages.failure(Cause::Adjustment, text);
    }
}

pub(super) fn written(
    model: &mut Model,
    values: &[(String, f64)],
    purpose: Purpose,
    result: Result<Box<Written>, String>,
    read_back: Option<&[NamedValue]>,
) {
    let (adjustment, text) = match result {
        Ok(adjustment) => {
            let open = model.open.as_ref();
            let kept = open.and_then(|open| adjusting::not_restored(open.session()));
            let text = adjusting::summary(&adjustment, purpose, values.len(), kept.as_deref());
            (Some(adjustment), text)
        }
        Err(error) => (None, format!("Nothing was written: {error}.")),
    };
    let holds = adjustment.as_ref().map(|a| &a.holds);
    let outcome = adjusting::outcome(holds, purpose, &text);
    conclude(model, outcome, &text, read_back);
    if holds == Some(&ControllerValues::New) {
        model.messages.info(&text);
    } else {
        model.messages.failure(Cause::Adjustment, &text);
    }
}

/// Settles an interrupted adjustment: at once if all values are old or all are new, otherwise when the controller is
/// armed.
pub(super) fn settle(model: &Model) {
    let open = model.open.as_ref().map(|open| open.session());
    if let Some(open) = open
        .and_then(adjusting::open)
        .filter(|_| !model.link.writing)
    {
        let [old, new] = adjusting::old_and_new(open);
        model.link.send(DriverCommand::Settle { old, new });
    }
}

pub(super) fn settled(
    model: &mut Model,
    found: &ControllerValues,
    adjustment: &Written,
    read_back: Option<&[NamedValue]>,
) {
    let session = model.open.as_ref().map(|open| open.session());
    let Some((session, open)) =
        session.and_then(|session| Some((session, adjusting::open(session)?)))
    else {
        return;
    };
    let kept = adjusting::not_restored(session);
    let (outcome, text) = adjusting::settled(open, found, adjustment, kept.as_deref());
    let is_settled = !matches!(outcome, Outcome::Unsettled(_));
    conclude(model, outcome, &text, read_back);
    match is_settled {
        true => model.messages.info(&text),
        false => model.messages.failure(Cause::Adjustment, &text),
    }
}

/// Records the outcome of an attempt.
fn conclude(model: &mut Model, outcome: Outcome, text: &str, read_back: Option<&[NamedValue]>) {
    model.messages.resolve(Cause::Adjustment);
    let holds = held(model);
    if let Some(open) = &mut model.open {
        open.record(|session| {
            session.conclude_adjustment(outcome, read_back, clock::now());
            if let Some(holds) = holds {
                session.controller = holds;
            }
        });
        open.log(LogPhase::Controller, text);
    }
}

/// Values of the session's simulated controller, stored for the next connection.
fn held(model: &Model) -> Option<Vec<NamedValue>> {
    let parameters = &model.link.parameters;
    (model.is_true_to_session() && !parameters.is_empty()).then(|| adjusting::held(parameters))
}

pub(super) fn verify(model: &mut Model, stage: Stage) {
    if refuses(model) {
        return;
    }
    let (Some(open), Some(connected)) = (&model.open, &model.link.connected) else {
        return;
    };
    if model.link.is_busy() || !model.link.is_armed() {
        return;
    }
    let robot = &open.session().robot;
    let workspace = connected.rig.workspace();
    let mut targets = cube_poses(robot, workspace);
    // The poses of two paths would be too many to type.
    if connected.rig.has_instrument() {
        targets.extend(circle(robot, workspace, POINTS.0));
        targets.extend(line(robot, workspace, POINTS.1));
    }
    let stopped = adjusting::to_continue(open.session(), stage);
    let rows = stopped.map_or_else(Vec::new, |stopped| stopped.rows.clone());
    let rows = if are_first_rows(&rows, &targets) {
        rows
    } else {
        Vec::new()
    };
    model.link.verify(targets, stage, rows);
    watch(model);
}

pub(super) fn verified(
    model: &mut Model,
    stage: Stage,
    rows: Vec<CheckRow>,
    result: Result<(), String>,
) {
    model.link.verifying = None;
    match result {
        Ok(()) => {
            let connected = model.link.connected.as_ref();
            let typed = connected.is_some_and(|c| !c.rig.has_instrument());
            let instrument = match typed {
                true => "typed by the operator",
                false => "with the simulated tracker",
            };
            add(model, stage, rows, instrument);
        }
        Err(error) => {
            model.link.is_stopped = model.link.is_connected();
            let kept = match rows.len() {
                0 => "has no result",
                _ => "is not complete; its measurements are kept",
            };
            model.messages.warning(format!(
                "The verification {kept}: {}.",
                error.trim_end_matches('.')
            ));
            keep_stopped(model, stage, rows, error);
        }
    }
}

/// Stores the rows of a verification that ended early.
fn keep_stopped(model: &mut Model, stage: Stage, rows: Vec<CheckRow>, reason: String) {
    let has_instrument = |c: &Connected| c.rig.has_instrument();
    let options = match model.link.connected.as_ref().is_some_and(has_instrument) {
        true => VerifyingOptions::default(),
        false => VerifyingOptions::typed(),
    };
    let planned = model.link.targets.len() * options.cycles;
    let Some(open) = model.open.as_mut().filter(|_| !rows.is_empty()) else {
        return;
    };
    let text = format!(
        "{}: stopped after {} of {planned} measurements.",
        title(stage),
        rows.len()
    );
    open.record(|session| {
        session.add_stopped_verification(StoppedVerification {
            time: clock::now(),
            stage,
            rows,
            planned,
            reason,
        });
    });
    open.log(LogPhase::Accuracy, text);
}

pub(super) fn take_check(model: &mut Model, stage: Stage) {
    let open = model.open.as_ref();
    let rows = open.map_or_else(Vec::new, |d| d.session().phases.check.clone());
    if !rows.is_empty() {
        add(model, stage, rows, "from the imported table");
    }
}

fn add(model: &mut Model, stage: Stage, rows: Vec<CheckRow>, source: &str) {
    let Some(open) = &mut model.open else {
        return;
    };
    let text = format!("{}: {} measurements {source}.", title(stage), rows.len());
    open.record(|session| {
        session.add_verification(Verification {
            time: clock::now(),
            title: title(stage).to_owned(),
            stage,
            rows,
            accepted: None,
        });
    });
    open.log(LogPhase::Accuracy, &text);
    model.messages.info(sentence(&text));
}

pub(super) fn reveal(model: &mut Model) {
    let Some(open) = &mut model.open else {
        return;
    };
    open.record(|session| {
        if let Some(simulator) = &mut session.simulator {
            simulator.revealed = true;
        }
    });
    open.log(LogPhase::Accuracy, "The hidden fault was revealed.");
}
