//! What the commands do; one file for each kind.

mod file;
mod import;
mod model;
mod plots;
pub mod robot;
mod view;

pub use file::{FileCommand, FileOutcome, Leaving, Opening, Purpose};
pub use model::{DIAGNOSING, IDENTIFYING, ModelCommand, ModelOutcome};
pub use plots::{PlotCommand, PlotOutcome};
pub use robot::{RobotCommand, RobotOutcome};
pub use view::{ViewCommand, restore};

use super::command::{Command, Outcome};
use super::keeping::Kept;
use super::state::State;

/// Does what a command says.
pub fn perform(state: &mut State, command: Command) {
    match command {
        Command::File(command) => file::perform(state, command),
        Command::View(command) => view::perform(state, command),
        Command::Model(command) => model::perform(state, command),
        Command::Robot(command) => robot::perform(state, command),
        Command::Plot(command) => plots::perform(state, command),
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

/// Takes what the keeper of unsaved sessions has to tell.
pub fn kept(state: &mut State, kept: Kept) {
    match kept {
        Kept::Measured(label) => robot::kept(state, label),
        Kept::Failed(text) => {
            robot::not_kept(state);
            state.messages.error(text);
        }
    }
}

/// Takes what a task came to.
pub fn receive(state: &mut State, outcome: Outcome) {
    match outcome {
        Outcome::File(outcome) => file::receive(state, outcome),
        Outcome::Model(outcome) => model::receive(state, outcome),
        Outcome::Robot(outcome) => robot::receive(state, outcome),
        Outcome::Plot(outcome) => plots::receive(state, outcome),
        Outcome::Panicked { task } => {
            state.messages.error(format!(
                "{task} broke down; the session is untouched. Please report this with the log."
            ));
        }
    }
}
