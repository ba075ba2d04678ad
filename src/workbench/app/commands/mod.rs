//! What the commands do; one file for each kind.

mod file;
mod import;
mod model;
mod view;

pub use file::{FileCommand, FileOutcome, Purpose};
pub use import::{ImportCommand, ImportOutcome};
pub use model::{DIAGNOSING, IDENTIFYING, ModelCommand, ModelOutcome};
pub use view::ViewCommand;

use std::path::PathBuf;

use super::command::{Command, Outcome};
use super::state::State;

/// Does what a command says.
pub fn perform(state: &mut State, command: Command) {
    match command {
        Command::File(command) => file::perform(state, command),
        Command::Import(command) => import::perform(state, command),
        Command::View(command) => view::perform(state, command),
        Command::Model(command) => model::perform(state, command),
        Command::Edit(edit) => {
            if let Some(document) = &mut state.document {
                document.edit(edit);
            }
        }
        Command::Undo => told(state, "Undone", |document| document.undo()),
        Command::Redo => told(state, "Done again", |document| document.redo()),
    }
}

fn told(state: &mut State, what: &str, step: impl FnOnce(&mut super::Document) -> Option<String>) {
    if let Some(name) = state.document.as_mut().and_then(step) {
        state.messages.info(format!("{what}: {name}."));
    }
}

/// What to do with a file that was dropped on the window.
pub fn dropped(path: PathBuf) -> Command {
    if path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
    {
        ImportCommand::ReadAny(path).into()
    } else {
        FileCommand::Open(path).into()
    }
}

/// Takes what a task came to.
pub fn receive(state: &mut State, outcome: Outcome) {
    match outcome {
        Outcome::File(outcome) => file::receive(state, outcome),
        Outcome::Import(outcome) => import::receive(state, outcome),
        Outcome::Model(outcome) => model::receive(state, outcome),
        Outcome::Panicked { task } => {
            state.messages.error(format!(
                "{task} broke down; the session is untouched. Please report this with the log."
            ));
        }
    }
}
