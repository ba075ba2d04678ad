//! Files of phases 3 and 5.

use std::path::PathBuf;

use tautline_link::export::{differences_csv, structured_text};
use tautline_session::{write_check, write_plan, write_text};

use super::adjust::differences;
use crate::model::command::{Export, Outcome, RobotOutcome};
use crate::shell::State;

pub(super) fn ask(state: &mut State, export: Export) {
    state.model.tasks.start("File dialog", move |_| {
        let dialog = rfd::FileDialog::new().set_file_name(export.file_name());
        Outcome::Robot(RobotOutcome::Picked(export, dialog.save_file()))
    });
}

pub(super) fn write(state: &mut State, export: Export, path: PathBuf) {
    let Some(text) = content(state, export) else {
        state
            .model
            .messages
            .warning("There is nothing to write yet.");
        return;
    };
    state.model.tasks.start("Writing a file", move |_| {
        let result = write_text(&path, &text).map_err(|error| error.to_string());
        Outcome::Robot(RobotOutcome::Exported(path, result))
    });
}

fn content(state: &State, export: Export) -> Option<String> {
    let open = state.model.open.as_ref()?;
    let session = open.session();
    let mut bytes = Vec::new();
    match export {
        Export::Plan if session.plan.is_empty() => return None,
        Export::Plan => write_plan(&mut bytes, &session.plan).ok()?,
        Export::Check => {
            let last = session.verifications().last()?;
            write_check(&mut bytes, &last.rows).ok()?;
        }
        Export::Differences => {
            let lines = differences(state);
            return (!lines.is_empty()).then(|| differences_csv(&lines));
        }
        Export::StructuredText => {
            let fit = open.fit().filter(|_| open.fit_is_current())?;
            let parameters = tautline_link::parameters::parameters_of(&fit.model);
            let title = format!("Identified parameters of {}", session.robot.name);
            return Some(structured_text(&title, &parameters));
        }
    }
    String::from_utf8(bytes).ok()
}
