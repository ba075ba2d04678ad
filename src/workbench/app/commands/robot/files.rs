//! Files of phases 3 and 5.

use std::path::PathBuf;

use tautline_link::export::{differences_csv, structured_text};
use tautline_session::{write_check, write_plan, write_text};

use super::RobotOutcome;
use super::adjust::differences;
use crate::app::command::Outcome;
use crate::app::state::State;

/// What is written to a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Export {
    /// The poses to measure, as a table.
    Plan,
    /// Parameters of the controller and identified ones, as a table.
    Differences,
    /// Identified parameters as constants in Structured Text.
    StructuredText,
    /// The last verification, as a table.
    Check,
}

impl Export {
    fn file_name(self) -> &'static str {
        match self {
            Self::Plan => "plan.csv",
            Self::Differences => "adjustment.csv",
            Self::StructuredText => "parameters.st",
            Self::Check => "check.csv",
        }
    }
}

pub(super) fn ask(state: &mut State, export: Export) {
    state.tasks.start("File dialog", move |_| {
        let dialog = rfd::FileDialog::new().set_file_name(export.file_name());
        Outcome::Robot(RobotOutcome::Picked(export, dialog.save_file()))
    });
}

pub(super) fn write(state: &mut State, export: Export, path: PathBuf) {
    let Some(text) = content(state, export) else {
        state.messages.warning("There is nothing to write yet.");
        return;
    };
    state.tasks.start("Writing a file", move |_| {
        let result = write_text(&path, &text).map_err(|error| error.to_string());
        Outcome::Robot(RobotOutcome::Exported(path, result))
    });
}

fn content(state: &State, export: Export) -> Option<String> {
    let document = state.document.as_ref()?;
    let session = document.session();
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
            let fit = document.fit().filter(|_| document.fit_is_current())?;
            let parameters = tautline_link::parameters::parameters_of(&fit.model);
            let title = format!("Identified parameters of {}", session.robot.name);
            return Some(structured_text(&title, &parameters));
        }
    }
    String::from_utf8(bytes).ok()
}
