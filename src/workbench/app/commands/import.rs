//! Tables that are imported into the open session.

use tautline_session::{Import, Phase, PhaseData};

use crate::app::Document;
use crate::app::edit::Edit;
use crate::app::screen::{Screen, Step};
use crate::app::state::State;

/// Takes a table into the open session; `file` is its name for messages.
pub(super) fn take(state: &mut State, file: &str, table: Import) {
    let Some(document) = &mut state.document else {
        state.messages.error(format!(
            "{file}: open a session first, then import tables into it."
        ));
        return;
    };
    match put(document, file, table) {
        Ok(step) => {
            state.messages.info(format!("Imported {file}."));
            state.screen = Screen::Phase(step);
        }
        Err(message) => state.messages.error(message),
    }
}

fn put(document: &mut Document, file: &str, table: Import) -> Result<Step, String> {
    let (step, phase) = match table {
        Import::Winch(rows) => (
            Step::Precalibration,
            phases(document, file, |phases| phases.winch = rows),
        ),
        Import::Force(rows) => (
            Step::Precalibration,
            phases(document, file, |phases| phases.force = rows),
        ),
        Import::Home(rows) => (
            Step::Precalibration,
            phases(document, file, |phases| phases.home = rows),
        ),
        Import::Elongation(rows) => (
            Step::Modeling,
            phases(document, file, |phases| phases.elongation = rows),
        ),
        Import::Check(rows) => (
            Step::Adjustment,
            phases(document, file, |phases| phases.check = rows),
        ),
        Import::Plan(plan) => {
            document.edit(Edit::SetPlan(plan, format!("import {file}")));
            (Step::Measuring, Phase::Poses)
        }
        Import::Poses(measurements) => {
            let there = document.session().measurements.len();
            if there > 0 {
                return Err(format!(
                    "{file}: the session has {there} measured poses already, and these are never replaced; open the \
                     folder of this file as a session of its own."
                ));
            }
            document.append(|session| session.measurements = *measurements);
            (Step::Measuring, Phase::Poses)
        }
        // What begins a session is handled before.
        Import::Session(_) | Import::Robot(_) | Import::Dataset(_) => {
            return Err(format!("{file}: this is no table."));
        }
    };
    document.log(phase, format!("Imported {file}."));
    Ok(step)
}

fn phases(document: &mut Document, file: &str, change: impl FnOnce(&mut PhaseData)) -> Phase {
    let mut phases = document.session().phases.clone();
    change(&mut phases);
    document.edit(Edit::SetPhases(Box::new(phases), format!("import {file}")));
    Phase::Instruments
}
