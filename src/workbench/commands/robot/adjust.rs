//! What is written to the controller, and how exactly the robot moves before and after.

use tautline_link::adjusting::{Adjustment as Written, Holds};
use tautline_link::verifying::{circle, cube_poses, line};
use tautline_session::{Adjustment, CheckRow, NamedValue, Phase as LogPhase, Stage, Verification};

use crate::model::Model;
use tautline_workflow::adjusting::title;
use tautline_workflow::adjusting::{self, Purpose};
use tautline_workflow::clock;
use tautline_workflow::wording::sentence;

/// Points of the circle and of the line.
const POINTS: (usize, usize) = (16, 9);

pub(super) fn write(model: &mut Model) {
    let fit = model.open.as_ref().and_then(|open| open.fit());
    if fit.is_some_and(|fit| !fit.solution.converged()) {
        model.dialogs.unconverged = true;
        return;
    }
    write_identified(model);
}

pub(super) fn write_unconverged(model: &mut Model, wanted: bool) {
    model.dialogs.unconverged = false;
    if wanted {
        write_identified(model);
    }
}

fn write_identified(model: &mut Model) {
    let values = adjusting::values_to_write(model.differences());
    give(model, values, Purpose::Adjust);
}

pub(super) fn roll_back(model: &mut Model) {
    let values = model
        .revertible()
        .map_or_else(Vec::new, adjusting::former_values);
    give(model, values, Purpose::RollBack);
}

fn give(model: &mut Model, values: Vec<(String, f64)>, purpose: Purpose) {
    if values.is_empty() || model.link.is_busy() || !model.link.is_armed() {
        return;
    }
    model.link.write(values, purpose);
}

pub(super) fn written(
    model: &mut Model,
    values: &[(String, f64)],
    purpose: Purpose,
    result: Result<Box<Written>, String>,
) {
    let (adjustment, text) = match result {
        Ok(adjustment) => {
            let text = adjusting::summary(&adjustment, purpose, values.len());
            (Some(adjustment), text)
        }
        Err(error) => (None, format!("Nothing was written: {error}.")),
    };
    let holds = adjustment.as_ref().map(|a| &a.holds);
    let outcome = adjusting::outcome(holds, purpose, &text);
    if holds == Some(&Holds::New) {
        model.messages.info(&text);
    } else {
        model.messages.error(&text);
    }
    let known = &model.link.parameters;
    let record = Adjustment {
        time: clock::now(),
        operator: model.preferences.operator.clone(),
        controller: model.link.identity.clone(),
        changes: adjustment.map_or_else(Vec::new, |a| adjusting::changes(known, &a.old, values)),
        outcome,
    };
    let held = held(model);
    if let Some(open) = &mut model.open {
        open.record(|session| {
            session.add_adjustment(record);
            if let Some(held) = held {
                session.controller = held;
            }
        });
        open.log(LogPhase::Accuracy, text);
    }
}

/// What the session's own simulated controller holds, to go on with it another time.
fn held(model: &Model) -> Option<Vec<NamedValue>> {
    let parameters = &model.link.parameters;
    (model.is_true_to_session() && !parameters.is_empty()).then(|| adjusting::held(parameters))
}

pub(super) fn verify(model: &mut Model, stage: Stage) {
    let (Some(open), Some(connected)) = (&model.open, &model.link.connected) else {
        return;
    };
    if model.link.is_busy() || !model.link.is_armed() {
        return;
    }
    let robot = &open.session().robot;
    let workspace = connected.rig.workspace();
    let mut targets = cube_poses(robot, workspace);
    // Nobody types the poses of two paths.
    if connected.rig.has_instrument() {
        targets.extend(circle(robot, workspace, POINTS.0));
        targets.extend(line(robot, workspace, POINTS.1));
    }
    model.link.verify(targets, stage);
}

pub(super) fn verified(model: &mut Model, stage: Stage, result: Result<Vec<CheckRow>, String>) {
    model.link.verifying = None;
    match result {
        Ok(rows) => {
            let connected = model.link.connected.as_ref();
            let typed = connected.is_some_and(|c| !c.rig.has_instrument());
            let instrument = match typed {
                true => "typed by the operator",
                false => "with the simulated tracker",
            };
            add(model, stage, rows, instrument);
        }
        Err(error) => model.messages.warning(format!(
            "The verification has no result: {}.",
            error.trim_end_matches('.')
        )),
    }
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
