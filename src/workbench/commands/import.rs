//! Import of the tables of phases 1 and 2.

use std::path::PathBuf;

use tautline_session::Loaded;

use crate::model::command::{ImportCommand, ImportOutcome, Outcome};
use crate::model::edit::Edit;
use crate::model::phase::{Phase, Screen};
use crate::screens::precalibration::Part;
use crate::shell::State;
use tautline_workflow::precalibration::{Table, TableRows};

pub(super) fn perform(state: &mut State, command: ImportCommand) {
    match command {
        ImportCommand::Ask(table) => state.model.tasks.start("File dialog", move |_| {
            let dialog = rfd::FileDialog::new().add_filter(table.file_name(), &["csv"]);
            let path = dialog.pick_file();
            ImportOutcome::Picked { table, path }.into()
        }),
        ImportCommand::Read(table, path) => read(state, table, path),
    }
}

fn read(state: &mut State, table: Table, path: PathBuf) {
    let Some(open) = &state.model.open else {
        let name = path.display();
        state.model.messages.error(format!(
            "{name}: is a table, expected a session, a robot.json or a dataset folder to be opened first."
        ));
        return;
    };
    let robot = open.session().robot.clone();
    state.model.tasks.start("Importing", move |_| {
        let result = table.read(&path, &robot).map_err(|error| error.to_string());
        Outcome::Import(ImportOutcome::Read { path, result })
    });
}

pub(super) fn receive(state: &mut State, outcome: ImportOutcome) {
    match outcome {
        ImportOutcome::Picked {
            table,
            path: Some(path),
        } => read(state, table, path),
        ImportOutcome::Picked { path: None, .. } => state.model.messages.info(
            "No file was chosen. If no dialog appeared, type the path or drop the file on the window.",
        ),
        ImportOutcome::Read {
            result: Err(error), ..
        } => state.model.messages.error(error),
        ImportOutcome::Read {
            path,
            result: Ok(loaded),
        } => {
            let name = path.file_name().unwrap_or(path.as_os_str());
            take(state, &name.to_string_lossy(), loaded);
        }
    }
}

/// Puts rows into the open session; `name` is that of their file.
pub(super) fn take(state: &mut State, name: &str, loaded: Loaded<TableRows>) {
    let Some(open) = &mut state.model.open else {
        return;
    };
    let rows = loaded.value;
    let table = rows.table();
    if !rows.suit(open.session().robot.cable_count()) {
        let message = format!("{name}: the robot was changed while it was read, import it again.");
        state.model.messages.error(message);
        return;
    }
    for notice in loaded.notices {
        state.model.messages.warning(notice);
    }
    let count = rows.row_count();
    let mut phases = open.session().phases.clone();
    rows.replace(&mut phases);
    open.edit(Edit::SetPhases(Box::new(phases), format!("import {name}")));
    state
        .model
        .messages
        .info(format!("Imported {count} rows from {name}."));
    show(state, table);
}

/// Goes to where the table is shown.
fn show(state: &mut State, table: Table) {
    let part = match table {
        Table::Winch => Part::Winches,
        Table::Force => Part::ForceSensors,
        Table::Home => Part::Home,
        Table::Elongation => {
            state.model.screen = Screen::Phase(Phase::Modeling);
            state.panels.modeling.show_elongation();
            return;
        }
    };
    state.model.screen = Screen::Phase(Phase::Precalibration);
    state.panels.precalibration.part = part;
}
