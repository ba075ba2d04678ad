//! Import of the tables of phases 1 and 2.

use std::path::PathBuf;

use tautline_session::Loaded;

use super::file_dialog::pick;
use super::file_tasks::file_label;
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{ImportCommand, ImportOutcome, Outcome};
use crate::model::edit::Edit;
use crate::model::messages::Cause;
use crate::model::phase::{Phase, Screen};
use crate::model::{Model, UiRequest};
use tautline_workflow::precalibration::{Table, TableRows};

pub(super) fn perform(model: &mut Model, command: ImportCommand) {
    match command {
        ImportCommand::Ask(table) => {
            let request = FileRequest::file(table.file_name(), &["csv"]);
            pick(model, request, move |path| ImportCommand::Read(table, path));
        }
        ImportCommand::Read(table, path) => read(model, table, path),
        ImportCommand::Show(table) => show(model, table),
    }
}

fn read(model: &mut Model, table: Table, path: PathBuf) {
    model.messages.resolve(Cause::Opening);
    let Some(open) = &model.open else {
        let name = path.display();
        let text = format!(
            "{name}: is a table, expected a session, a robot.json or a dataset folder to be opened first."
        );
        model.messages.failure(Cause::Opening, text);
        return;
    };
    let robot = open.session().robot.clone();
    model.tasks.start("Importing", move |_| {
        let result = table.read(&path, &robot).map_err(|error| error.to_string());
        Outcome::Import(ImportOutcome { path, result })
    });
}

pub(super) fn receive(model: &mut Model, ImportOutcome { path, result }: ImportOutcome) {
    match result {
        Ok(loaded) => take(model, &file_label(&path), loaded),
        Err(error) => model.messages.failure(Cause::Opening, error),
    }
}

/// Puts the rows of a file into the open session.
pub(super) fn take(model: &mut Model, name: &str, loaded: Loaded<TableRows>) {
    let Some(open) = &mut model.open else {
        return;
    };
    let rows = loaded.value;
    let table = rows.table();
    if !rows.suit(open.session().robot.cable_count()) {
        let message = format!("{name}: the robot was changed while it was read, import it again.");
        model.messages.failure(Cause::Opening, message);
        return;
    }
    model.messages.warnings(loaded.notices);
    let count = rows.row_count();
    let mut phases = open.session().phases.clone();
    rows.replace(&mut phases);
    open.edit(Edit::SetPhases(Box::new(phases), format!("import {name}")));
    model
        .messages
        .info(format!("Imported {count} rows from {name}."));
    show(model, table);
}

/// Shows the table in its phase.
fn show(model: &mut Model, table: Table) {
    model.screen = Screen::Phase(match table {
        Table::Winch | Table::Force | Table::Home => Phase::Precalibration,
        Table::Elongation => Phase::Modeling,
    });
    model.request(UiRequest::ShowTable(table));
}
