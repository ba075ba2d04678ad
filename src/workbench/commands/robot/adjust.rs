//! What is written to the controller, and how exactly the robot moves before and after.

use tautline_link::adjusting::{Adjustment as Written, Difference, Holds, plan_adjustment};
use tautline_link::verifying::{circle, cube_poses, line};
use tautline_session::{Adjustment, CheckRow, NamedValue, Phase as LogPhase, Stage, Verification};

use super::is_true_to_session;
use crate::shell::State;
pub use tautline_workflow::adjusting::title;
use tautline_workflow::adjusting::{self, Purpose};
use tautline_workflow::clock;
use tautline_workflow::wording::sentence;

/// Points of the circle and of the line.
const POINTS: (usize, usize) = (16, 9);

/// What the controller holds beside what was identified; empty without an identification that is up to date.
#[must_use]
pub fn differences(state: &State) -> Vec<Difference> {
    let Some(open) = state.model.open.as_ref().filter(|d| d.fit_is_current()) else {
        return Vec::new();
    };
    open.fit().map_or_else(Vec::new, |fit| {
        plan_adjustment(
            &state.model.link.parameters,
            &fit.model,
            Some(&fit.solution),
        )
    })
}

/// The last adjustment, if it can be taken back.
#[must_use]
pub fn revertible(state: &State) -> Option<&Adjustment> {
    adjusting::revertible(state.model.open.as_ref()?.session())
}

pub(super) fn write(state: &mut State) {
    let fit = state.model.open.as_ref().and_then(|open| open.fit());
    if fit.is_some_and(|fit| !fit.solution.converged()) {
        state.model.dialogs.unconverged = true;
        return;
    }
    write_identified(state);
}

pub(super) fn write_unconverged(state: &mut State, wanted: bool) {
    state.model.dialogs.unconverged = false;
    if wanted {
        write_identified(state);
    }
}

fn write_identified(state: &mut State) {
    let values = adjusting::values_to_write(differences(state));
    give(state, values, Purpose::Adjust);
}

pub(super) fn roll_back(state: &mut State) {
    let values = revertible(state).map_or_else(Vec::new, adjusting::former_values);
    give(state, values, Purpose::RollBack);
}

fn give(state: &mut State, values: Vec<(String, f64)>, purpose: Purpose) {
    if values.is_empty() || state.model.link.is_busy() || !state.model.link.is_armed() {
        return;
    }
    state.model.link.write(values, purpose);
}

pub(super) fn written(
    state: &mut State,
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
        state.model.messages.info(&text);
    } else {
        state.model.messages.error(&text);
    }
    let known = &state.model.link.parameters;
    let record = Adjustment {
        time: clock::now(),
        operator: state.model.preferences.operator.clone(),
        controller: state.model.link.identity.clone(),
        changes: adjustment.map_or_else(Vec::new, |a| adjusting::changes(known, &a.old, values)),
        outcome,
    };
    let held = held(state);
    if let Some(open) = &mut state.model.open {
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
fn held(state: &State) -> Option<Vec<NamedValue>> {
    let parameters = &state.model.link.parameters;
    (is_true_to_session(state) && !parameters.is_empty()).then(|| adjusting::held(parameters))
}

pub(super) fn verify(state: &mut State, stage: Stage) {
    let (Some(open), Some(connected)) = (&state.model.open, &state.model.link.connected) else {
        return;
    };
    if state.model.link.is_busy() || !state.model.link.is_armed() {
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
    state.model.link.verify(targets, stage);
}

pub(super) fn verified(state: &mut State, stage: Stage, result: Result<Vec<CheckRow>, String>) {
    state.model.link.verifying = None;
    match result {
        Ok(rows) => {
            let connected = state.model.link.connected.as_ref();
            let typed = connected.is_some_and(|c| !c.rig.has_instrument());
            let instrument = match typed {
                true => "typed by the operator",
                false => "with the simulated tracker",
            };
            add(state, stage, rows, instrument);
        }
        Err(error) => state.model.messages.warning(format!(
            "The verification has no result: {}.",
            error.trim_end_matches('.')
        )),
    }
}

pub(super) fn take_check(state: &mut State, stage: Stage) {
    let open = state.model.open.as_ref();
    let rows = open.map_or_else(Vec::new, |d| d.session().phases.check.clone());
    if !rows.is_empty() {
        add(state, stage, rows, "from the imported table");
    }
}

fn add(state: &mut State, stage: Stage, rows: Vec<CheckRow>, source: &str) {
    let Some(open) = &mut state.model.open else {
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
    state.model.messages.info(sentence(&text));
}

pub(super) fn reveal(state: &mut State) {
    let Some(open) = &mut state.model.open else {
        return;
    };
    open.record(|session| {
        if let Some(simulator) = &mut session.simulator {
            simulator.revealed = true;
        }
    });
    open.log(LogPhase::Accuracy, "The hidden fault was revealed.");
}
