//! What the commands do; one file for each kind.

mod compare;
mod file;
mod import;
mod model;
mod plots;
mod report;
pub mod robot;
mod tables;
mod view;

pub use crate::app::compared::{Side, Source};
pub use compare::{COMPARING, CompareCommand, CompareOutcome};
pub use file::{FileCommand, FileOutcome, Leaving, Opening, Purpose, search};
pub use import::{ImportCommand, ImportOutcome};
pub use model::{DIAGNOSING, IDENTIFYING, ModelCommand, ModelOutcome};
pub use plots::{PlotCommand, PlotOutcome};
pub use report::{ReportCommand, ReportOutcome, SavingReport};
pub use robot::{RobotCommand, RobotOutcome};
pub use view::{PoseStep, ViewCommand, restore};

use super::command::{Command, Outcome};
use super::keeping::Kept;
use super::state::State;

/// Does what a command says.
pub fn perform(state: &mut State, command: Command) {
    match command {
        Command::File(command) => file::perform(state, command),
        Command::Import(command) => import::perform(state, command),
        Command::View(command) => view::perform(state, command),
        Command::Model(command) => model::perform(state, command),
        Command::Robot(command) => robot::perform(state, command),
        Command::Plot(command) => plots::perform(state, command),
        Command::Report(command) => report::perform(state, command),
        Command::Compare(command) => compare::perform(state, command),
        Command::Edit(edit) => changed(state, None, |document| {
            let name = edit.name();
            document.edit(edit).then_some(name)
        }),
        Command::Undo => changed(state, Some("Undone"), super::Document::undo),
        Command::Redo => changed(state, Some("Done again"), super::Document::redo),
    }
}

/// Does, undoes or redoes an edit; what was computed follows.
fn changed(
    state: &mut State,
    told: Option<&str>,
    step: impl FnOnce(&mut super::Document) -> Option<String>,
) {
    let before = model::Model::of(state);
    let Some(name) = state.document.as_mut().and_then(step) else {
        return;
    };
    let what = told.map_or_else(|| name.clone(), |told| format!("{told}: {name}"));
    if told.is_some() {
        state.messages.info(format!("{what}."));
    }
    model::follow(state, before.as_ref(), &what);
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
        Outcome::Import(outcome) => import::receive(state, outcome),
        Outcome::Model(outcome) => model::receive(state, outcome),
        Outcome::Robot(outcome) => robot::receive(state, outcome),
        Outcome::Plot(outcome) => plots::receive(state, outcome),
        Outcome::Report(outcome) => report::receive(state, outcome),
        Outcome::Compare(outcome) => compare::receive(state, outcome),
        Outcome::Panicked { task, breakdown } => {
            state.messages.error(format!(
                "{task} broke down; the session is untouched. Please report this with the log."
            ));
            state.breakdown = Some(breakdown);
        }
    }
}
