//! Tables that were opened or dropped on the window, into the open session.

use tautline_session::{Import, Loaded, Phase};

use super::import;
use crate::app::Document;
use crate::app::edit::Edit;
use crate::app::screen::{Screen, Step};
use crate::app::state::State;
use tautline_workflow::precalibration::TableRows;

/// Takes a table into the open session; `file` is its name for messages.
pub(super) fn take(state: &mut State, file: &str, table: Import) {
    let rows = match table {
        Import::Winch(rows) => TableRows::Winch(rows),
        Import::Force(rows) => TableRows::Force(rows),
        Import::Home(rows) => TableRows::Home(rows),
        Import::Elongation(rows) => TableRows::Elongation(rows),
        table => return put(state, file, table),
    };
    import::take(
        state,
        file,
        Loaded {
            value: rows,
            notices: Vec::new(),
        },
    );
}

fn put(state: &mut State, file: &str, table: Import) {
    let Some(document) = &mut state.document else {
        let message = format!(
            "{file}: is a table, expected a session, a robot.json or a dataset folder to be opened first."
        );
        state.messages.error(message);
        return;
    };
    match into(document, file, table) {
        Ok(step) => {
            document.log(Phase::Poses, format!("Imported {file}."));
            state.messages.info(format!("Imported {file}."));
            state.screen = Screen::Phase(step);
        }
        Err(message) => state.messages.error(message),
    }
}

fn into(document: &mut Document, file: &str, table: Import) -> Result<Step, String> {
    match table {
        Import::Check(rows) => {
            let mut phases = document.session().phases.clone();
            phases.check = rows;
            document.edit(Edit::SetPhases(Box::new(phases), format!("import {file}")));
            Ok(Step::Adjustment)
        }
        Import::Plan(plan) => {
            document.edit(Edit::SetPlan(plan, format!("import {file}")));
            Ok(Step::Measuring)
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
            Ok(Step::Measuring)
        }
        _ => Err(format!("{file}: is no table that a session takes.")),
    }
}
