//! Handlers of the commands, one file for each kind.

mod compare;
mod file;
mod file_dialog;
mod file_tasks;
mod hypothesis;
mod identification;
mod import;
mod plots;
mod record;
mod recording;
mod report;
pub mod robot;
mod setup;
mod study;
mod tables;
mod view;

pub use self::file::find_unsaved;
pub use self::view::restore;

use tautline_core::effect::EffectSetting;

use crate::model::autosave::AutosaveEvent;
use crate::model::command::{Command, Outcome, PendingAction};
use crate::model::edit::Edit;
use crate::model::messages::Cause;
use crate::model::{Model, OpenSession, UiRequest};

pub fn perform(model: &mut Model, command: Command) {
    if let Some(text) = model
        .session_lock
        .refusal()
        .filter(|_| command.acts_on_session())
    {
        return model.messages.failure(Cause::Opening, text);
    }
    match command {
        Command::File(command) => file::perform(model, command),
        Command::Import(command) => import::perform(model, command),
        Command::Recording(command) => recording::perform(model, command),
        Command::View(command) => view::perform(model, command),
        Command::Identification(command) => identification::perform(model, command),
        Command::Robot(command) if command.disconnects() => {
            file::leave(model, PendingAction::Robot(command));
        }
        Command::Robot(command) => robot::perform(model, command),
        Command::Plot(command) => plots::perform(model, command),
        Command::Report(command) => report::perform(model, command),
        Command::Compare(command) => compare::perform(model, command),
        Command::Record(command) => record::perform(model, command),
        Command::Study(command) => study::perform(model, command),
        Command::Hypothesis(command) => hypothesis::perform(model, command),
        Command::Edit(edit) => {
            let adds = match &edit {
                Edit::AddEffects(effects, _) => Some(effects.clone()),
                Edit::AddPattern { effect, .. } => Some(vec![EffectSetting::clone(effect)]),
                _ => None,
            };
            changed(model, None, adds, |open| {
                let name = edit.name();
                open.edit(edit).then_some(name)
            });
        }
        Command::CancelTask(title) => model.tasks.cancel(title),
        Command::Refuse(text) => model.messages.failure(Cause::Entry, text),
        Command::Undo if recording::undoes(model, false) => recording::undo(model),
        Command::Redo if recording::undoes(model, true) => recording::redo(model),
        Command::Undo => changed(model, Some("Undone"), None, OpenSession::undo),
        Command::Redo => changed(model, Some("Redone"), None, OpenSession::redo),
    }
}

/// Applies, undoes or redoes an edit and updates the results.
fn changed(
    model: &mut Model,
    prefix: Option<&str>,
    adds: Option<Vec<EffectSetting>>,
    step: impl FnOnce(&mut OpenSession) -> Option<String>,
) {
    let before = identification::FitChoices::of(model);
    let Some(name) = model.open.as_mut().and_then(step) else {
        return;
    };
    // Errors of the session before no longer apply.
    for cause in [Cause::Entry, Cause::Estimation, Cause::Planning] {
        model.messages.resolve(cause);
    }
    let what = prefix.map_or_else(|| name.clone(), |prefix| format!("{prefix}: {name}"));
    if prefix.is_some() {
        model.messages.info(format!("{what}."));
    }
    identification::follow(model, before.as_ref(), &what, adds);
}

/// Handles an event of the autosave.
pub fn autosaved(model: &mut Model, event: AutosaveEvent) {
    match event {
        AutosaveEvent::Measured(label) => {
            model.messages.resolve(Cause::Autosave);
            robot::autosaved(model, label);
        }
        AutosaveEvent::Kept => {
            model.messages.resolve(Cause::Autosave);
            robot::recorded(model);
        }
        AutosaveEvent::Failed(text) => {
            robot::autosave_failed(model);
            model.messages.failure(Cause::Autosave, text);
        }
    }
}

/// Handles the outcome of a task.
pub fn receive(model: &mut Model, outcome: Outcome) {
    match outcome {
        Outcome::File(outcome) => file::receive(model, outcome),
        Outcome::Import(outcome) => import::receive(model, outcome),
        Outcome::Recording(outcome) => recording::receive(model, outcome),
        Outcome::Identification(outcome) => identification::receive(model, outcome),
        Outcome::Prepared(prepared) => model.request(UiRequest::TakePreparation(prepared)),
        Outcome::Plan(outcome) => robot::planned(model, outcome),
        Outcome::Corrected(outcome) => model.corrected = Some(outcome),
        Outcome::Setup(outcome) => setup::receive(model, outcome),
        Outcome::Compare(outcome) => compare::receive(model, outcome),
        Outcome::Simulator(outcome) => model.comparison.simulator = Some(outcome),
        Outcome::Record(outcome) => record::receive(model, outcome),
        Outcome::Hypothesis(outcome) => hypothesis::receive(model, outcome),
        Outcome::Picked(Some(command)) => perform(model, *command),
        Outcome::Picked(None) => {}
        Outcome::NoFileDialog(choice) => model.dialogs.chooser = Some(choice.into()),
        Outcome::Written(path, result) => {
            if let Ok(Some(warning)) = &result {
                model.messages.warning(warning);
            }
            file_tasks::written(model, &path, result.map(|_| ()));
        }
        Outcome::Panicked { task, caught_panic } => {
            model.messages.error(format!(
                "{task} failed with an internal error; the session is unchanged. Please report this with the log."
            ));
            model.caught_panic = Some(caught_panic);
        }
    }
}
