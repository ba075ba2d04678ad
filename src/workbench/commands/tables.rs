//! Import of opened or dropped tables into the open session.

use tautline_session::{Import, Loaded, Phase as LogPhase};

use super::import;
use crate::model::edit::Edit;
use crate::model::messages::Cause;
use crate::model::phase::{Phase, Screen};
use crate::model::{Model, OpenSession};
use tautline_workflow::precalibration::TableRows;

/// Adds a table to the open session; `file` is its name in messages.
pub(super) fn take(model: &mut Model, file: &str, table: Import) {
    let rows = match table {
        Import::Winch(rows) => TableRows::Winch(rows),
        Import::Force(rows) => TableRows::Force(rows),
        Import::Home(rows) => TableRows::Home(rows),
        Import::Elongation(rows) => TableRows::Elongation(rows),
        table => return put(model, file, table),
    };
    import::take(
        model,
        file,
        Loaded {
            value: rows,
            notices: Vec::new(),
        },
    );
}

fn put(model: &mut Model, file: &str, table: Import) {
    let Some(open) = &mut model.open else {
        let message = format!(
            "{file}: is a table, expected a session, a robot.json or a dataset folder to be opened first."
        );
        model.messages.failure(Cause::Opening, message);
        return;
    };
    match into(open, file, table) {
        Ok(step) => {
            open.log(LogPhase::Poses, format!("Imported {file}."));
            model.messages.info(format!("Imported {file}."));
            model.screen = Screen::Phase(step);
        }
        Err(message) => model.messages.failure(Cause::Opening, message),
    }
}

fn into(open: &mut OpenSession, file: &str, table: Import) -> Result<Phase, String> {
    match table {
        Import::Check(rows) => {
            let mut phases = open.session().phases.clone();
            phases.check = rows;
            open.edit(Edit::SetPhases(Box::new(phases), format!("import {file}")));
            Ok(Phase::Adjustment)
        }
        Import::Distances(rows) => {
            let mut phases = open.session().phases.clone();
            phases.distances = rows;
            open.edit(Edit::SetPhases(Box::new(phases), format!("import {file}")));
            Ok(Phase::Measuring)
        }
        Import::Plan(plan) => {
            open.edit(Edit::SetPlan(plan, format!("import {file}")));
            Ok(Phase::Measuring)
        }
        Import::Poses(measurements) => {
            let there = open.session().measurements.len();
            if there > 0 {
                return Err(format!(
                    "{file}: the session has {there} measured poses already, and these are never replaced; open the \
                     folder of this file as a session of its own."
                ));
            }
            open.append(|session| session.measurements = *measurements);
            Ok(Phase::Measuring)
        }
        _ => Err(format!("{file}: not a table that a session can have.")),
    }
}
