//! What the commands do; one file for each kind.

mod compare;
mod file;
mod identification;
mod import;
mod plots;
mod report;
pub mod robot;
mod tables;
mod view;

pub use self::file::search;
pub use self::view::restore;

use crate::model::OpenSession;
use crate::model::autosave::AutosaveEvent;
use crate::model::command::{Command, Outcome};
use crate::shell::State;

/// Does what a command says.
pub fn perform(state: &mut State, command: Command) {
    match command {
        Command::File(command) => file::perform(state, command),
        Command::Import(command) => import::perform(state, command),
        Command::View(command) => view::perform(state, command),
        Command::Identification(command) => identification::perform(state, command),
        Command::Robot(command) => robot::perform(state, command),
        Command::Plot(command) => plots::perform(state, command),
        Command::Report(command) => report::perform(state, command),
        Command::Compare(command) => compare::perform(state, command),
        Command::Edit(edit) => changed(state, None, |open| {
            let name = edit.name();
            open.edit(edit).then_some(name)
        }),
        Command::Undo => changed(state, Some("Undone"), OpenSession::undo),
        Command::Redo => changed(state, Some("Done again"), OpenSession::redo),
    }
}

/// Does, undoes or redoes an edit; what was computed follows.
fn changed(
    state: &mut State,
    told: Option<&str>,
    step: impl FnOnce(&mut OpenSession) -> Option<String>,
) {
    let before = identification::Model::of(state);
    let Some(name) = state.model.open.as_mut().and_then(step) else {
        return;
    };
    let what = told.map_or_else(|| name.clone(), |told| format!("{told}: {name}"));
    if told.is_some() {
        state.model.messages.info(format!("{what}."));
    }
    identification::follow(state, before.as_ref(), &what);
}

/// Takes what the keeper of unsaved sessions has to tell.
pub fn kept(state: &mut State, kept: AutosaveEvent) {
    match kept {
        AutosaveEvent::Measured(label) => robot::kept(state, label),
        AutosaveEvent::Failed(text) => {
            robot::not_kept(state);
            state.model.messages.error(text);
        }
    }
}

/// Takes what a task came to.
pub fn receive(state: &mut State, outcome: Outcome) {
    match outcome {
        Outcome::File(outcome) => file::receive(state, outcome),
        Outcome::Import(outcome) => import::receive(state, outcome),
        Outcome::Identification(outcome) => identification::receive(state, outcome),
        Outcome::Robot(outcome) => robot::receive(state, outcome),
        Outcome::Plot(outcome) => plots::receive(state, outcome),
        Outcome::Report(outcome) => report::receive(state, outcome),
        Outcome::Compare(outcome) => compare::receive(state, outcome),
        Outcome::Panicked { task, caught_panic } => {
            state.model.messages.error(format!(
                "{task} broke down; the session is untouched. Please report this with the log."
            ));
            state.model.caught_panic = Some(caught_panic);
        }
    }
}
