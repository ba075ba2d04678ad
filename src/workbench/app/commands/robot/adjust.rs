//! What is written to the controller, and how exactly the robot moves before and after.

use tautline_link::adjusting::{self, Difference, Holds, plan_adjustment};
use tautline_link::verifying::{circle, cube_poses, line};
use tautline_session::{
    Adjustment, CheckRow, NamedValue, Outcome, Phase, Stage, ValueChange, Verification,
};

use super::is_true_to_session;
use crate::app::clock;
use crate::app::robot::Purpose;
use crate::app::state::State;
use crate::wording::sentence;

/// Points of the circle and of the line.
const POINTS: (usize, usize) = (16, 9);

/// What the controller holds beside what was identified; empty without an identification that is up to date.
#[must_use]
pub fn differences(state: &State) -> Vec<Difference> {
    let Some(document) = state.document.as_ref().filter(|d| d.fit_is_current()) else {
        return Vec::new();
    };
    document.fit().map_or_else(Vec::new, |fit| {
        plan_adjustment(&state.link.parameters, &fit.model, Some(&fit.solution))
    })
}

/// The last adjustment, if it can be taken back.
#[must_use]
pub fn revertible(state: &State) -> Option<&Adjustment> {
    let last = state.document.as_ref()?.session().adjustments().last()?;
    (last.outcome == Outcome::Written && !last.changes.is_empty()).then_some(last)
}

pub(super) fn write(state: &mut State) {
    let values: Vec<(String, f64)> = differences(state)
        .into_iter()
        .filter(Difference::is_writable_change)
        .map(|difference| (difference.name, difference.identified))
        .collect();
    give(state, values, Purpose::Adjust);
}

pub(super) fn roll_back(state: &mut State) {
    let values = revertible(state).map_or_else(Vec::new, |last| {
        let changes = last.changes.iter();
        changes
            .map(|change| (change.name.clone(), change.before))
            .collect()
    });
    give(state, values, Purpose::RollBack);
}

fn give(state: &mut State, values: Vec<(String, f64)>, purpose: Purpose) {
    if values.is_empty() || state.link.is_busy() || !state.link.is_armed() {
        return;
    }
    state.link.write(values, purpose);
}

pub(super) fn written(
    state: &mut State,
    values: &[(String, f64)],
    purpose: Purpose,
    result: Result<Box<adjusting::Adjustment>, String>,
) {
    let (adjustment, text) = match result {
        Ok(adjustment) => {
            let text = told(&adjustment, purpose, values.len());
            (Some(adjustment), text)
        }
        Err(error) => (None, format!("Nothing was written: {error}.")),
    };
    let done = adjustment.as_ref().is_some_and(|a| a.holds == Holds::New);
    if done {
        state.messages.info(&text);
    } else {
        state.messages.error(&text);
    }
    let outcome = match (done, purpose) {
        (true, Purpose::Adjust) => Outcome::Written,
        (true, Purpose::RollBack) => Outcome::RolledBack,
        (false, _) => Outcome::Failed(text.clone()),
    };
    let record = Adjustment {
        time: clock::now(),
        operator: state.preferences.operator.clone(),
        controller: state.link.identity.clone(),
        changes: adjustment.map_or_else(Vec::new, |a| changes(state, &a.old, values)),
        outcome,
    };
    let held = held(state);
    if let Some(document) = &mut state.document {
        document.record(|session| {
            session.add_adjustment(record);
            if let Some(held) = held {
                session.controller = held;
            }
        });
        document.log(Phase::Accuracy, text);
    }
}

fn told(adjustment: &adjusting::Adjustment, purpose: Purpose, values: usize) -> String {
    let what = match (&adjustment.holds, purpose) {
        (Holds::New, Purpose::Adjust) => {
            format!(
                "The identified values are in the controller and were read back ({values} changed)."
            )
        }
        (Holds::New, Purpose::RollBack) => {
            format!("The controller holds the former values again ({values} changed).")
        }
        (Holds::Old, _) => "The values were not written.".to_owned(),
        (Holds::Mixed(names), _) => {
            format!("Attention: {} values are half written.", names.len())
        }
        (Holds::Unknown, _) => "Attention: what the controller holds is not known.".to_owned(),
    };
    let problem = adjustment.problem.as_deref().unwrap_or_default();
    let advice = match purpose {
        Purpose::RollBack if adjustment.holds == Holds::New => "",
        _ => adjustment.advice.as_str(),
    };
    [what.as_str(), problem, advice].join(" ").trim().to_owned()
}

fn changes(state: &State, old: &[(String, f64)], new: &[(String, f64)]) -> Vec<ValueChange> {
    let unit = |name: &str| {
        let known = state.link.parameters.iter().find(|p| p.name == name);
        known.map_or("", |parameter| parameter.unit).to_owned()
    };
    let pairs = old.iter().zip(new);
    pairs
        .map(|((name, before), (_, after))| ValueChange {
            name: name.clone(),
            unit: unit(name),
            before: *before,
            after: *after,
        })
        .collect()
}

/// What the session's own simulated controller holds, to go on with it another time.
fn held(state: &State) -> Option<Vec<NamedValue>> {
    let parameters = state.link.parameters.iter();
    (is_true_to_session(state) && !state.link.parameters.is_empty()).then(|| {
        parameters
            .map(|parameter| NamedValue {
                name: parameter.name.clone(),
                value: parameter.value,
            })
            .collect()
    })
}

pub(super) fn verify(state: &mut State, stage: Stage) {
    let (Some(document), Some(connected)) = (&state.document, &state.link.connected) else {
        return;
    };
    if state.link.is_busy() || !state.link.is_armed() {
        return;
    }
    let robot = &document.session().robot;
    let workspace = connected.rig.workspace();
    let mut targets = cube_poses(robot, workspace);
    targets.extend(circle(robot, workspace, POINTS.0));
    targets.extend(line(robot, workspace, POINTS.1));
    state.link.verify(targets, stage);
}

/// What a run of a stage is called.
#[must_use]
pub fn title(stage: Stage) -> &'static str {
    match stage {
        Stage::Before => "Before the adjustment",
        Stage::After => "After the adjustment",
    }
}

pub(super) fn verified(state: &mut State, stage: Stage, result: Result<Vec<CheckRow>, String>) {
    state.link.verifying = None;
    match result {
        Ok(rows) => {
            let instrument = "with the simulated tracker";
            add(state, stage, rows, instrument);
        }
        Err(error) => state.messages.warning(format!(
            "The verification has no result: {}.",
            error.trim_end_matches('.')
        )),
    }
}

pub(super) fn take_check(state: &mut State, stage: Stage) {
    let document = state.document.as_ref();
    let rows = document.map_or_else(Vec::new, |d| d.session().phases.check.clone());
    if !rows.is_empty() {
        add(state, stage, rows, "from the imported table");
    }
}

fn add(state: &mut State, stage: Stage, rows: Vec<CheckRow>, source: &str) {
    let Some(document) = &mut state.document else {
        return;
    };
    let text = format!("{}: {} measurements {source}.", title(stage), rows.len());
    document.record(|session| {
        session.add_verification(Verification {
            time: clock::now(),
            title: title(stage).to_owned(),
            stage,
            rows,
        });
    });
    document.log(Phase::Accuracy, &text);
    state.messages.info(sentence(&text));
}

pub(super) fn reveal(state: &mut State) {
    let Some(document) = &mut state.document else {
        return;
    };
    document.record(|session| {
        if let Some(simulator) = &mut session.simulator {
            simulator.revealed = true;
        }
    });
    document.log(Phase::Accuracy, "The hidden fault was revealed.");
}
