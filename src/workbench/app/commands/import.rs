//! Import of the tables of phases 1 and 2.

use std::path::PathBuf;

use tautline_session::Loaded;

use crate::app::command::Outcome;
use crate::app::edit::Edit;
use crate::app::screen::{Screen, Step};
use crate::app::state::State;
use crate::screens::precalibration::Part;
use tautline_workflow::precalibration::{Table, TableRows};

/// Imports a table.
#[derive(Debug, Clone)]
pub enum ImportCommand {
    /// Asks for its file.
    Ask(Table),
    /// Reads it from a file.
    Read(Table, PathBuf),
}

/// What an import came to.
#[derive(Debug)]
pub enum ImportOutcome {
    /// A file dialog was closed.
    Picked {
        /// The table it was for.
        table: Table,
        /// What was picked; `None` if the dialog was cancelled or is not available.
        path: Option<PathBuf>,
    },
    /// A file was read.
    Read {
        /// The file.
        path: PathBuf,
        /// Its rows, or one sentence.
        result: Result<Loaded<TableRows>, String>,
    },
}

pub(super) fn perform(state: &mut State, command: ImportCommand) {
    match command {
        ImportCommand::Ask(table) => state.tasks.start("File dialog", move |_| {
            let dialog = rfd::FileDialog::new().add_filter(table.file_name(), &["csv"]);
            let path = dialog.pick_file();
            ImportOutcome::Picked { table, path }.into()
        }),
        ImportCommand::Read(table, path) => read(state, table, path),
    }
}

fn read(state: &mut State, table: Table, path: PathBuf) {
    let Some(document) = &state.document else {
        let name = path.display();
        state.messages.error(format!(
            "{name}: is a table, expected a session, a robot.json or a dataset folder to be opened first."
        ));
        return;
    };
    let robot = document.session().robot.clone();
    state.tasks.start("Importing", move |_| {
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
        ImportOutcome::Picked { path: None, .. } => state.messages.info(
            "No file was chosen. If no dialog appeared, type the path or drop the file on the window.",
        ),
        ImportOutcome::Read {
            result: Err(error), ..
        } => state.messages.error(error),
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
    let Some(document) = &mut state.document else {
        return;
    };
    let rows = loaded.value;
    let table = rows.table();
    if !rows.suit(document.session().robot.cable_count()) {
        let message = format!("{name}: the robot was changed while it was read, import it again.");
        state.messages.error(message);
        return;
    }
    for notice in loaded.notices {
        state.messages.warning(notice);
    }
    let count = rows.row_count();
    let mut phases = document.session().phases.clone();
    rows.replace(&mut phases);
    document.edit(Edit::SetPhases(Box::new(phases), format!("import {name}")));
    state
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
            state.screen = Screen::Phase(Step::Modeling);
            state.screens.modeling.show_elongation();
            return;
        }
    };
    state.screen = Screen::Phase(Step::Precalibration);
    state.screens.precalibration.part = part;
}
